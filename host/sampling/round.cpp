#include "sampling/round.hpp"

#include <algorithm>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Samples per pixel in a slice: all if they fit, else whole pairs of batches, or one batch.
std::uint32_t samples_at_once(const SampleGroup& group, std::uint32_t slice_samples) {
  if (group.samples <= slice_samples) return group.samples;
  const std::uint32_t pairs = slice_samples / (2 * DAPPLE_SAMPLE_BATCH);
  return pairs ? pairs * 2 * DAPPLE_SAMPLE_BATCH : DAPPLE_SAMPLE_BATCH;
}

/// Maximum number of pixels in a CPU's slice: for 65,535 work-items or more PoCL compiles kernels
/// again (experiment 707). The large slices of GPUs have more pixels: kernels that run one in each
/// work-item need them to fill the device.
constexpr std::uint32_t kMaxEntries = 65'472;

/// Samples of a pixel at least, on average over a slice of the largest number of pixels.
constexpr std::uint32_t kMinSamplesOfEntry = 32;

std::uint32_t entries_at_once(const SampleGroup& group, std::uint32_t slice_samples) {
  return std::min(slice_samples / samples_at_once(group, slice_samples),
                  max_entries(slice_samples));
}

void take_back(std::uint32_t& samples, std::uint32_t pending) {
  if (pending > samples) {
    throw Error(ErrorKind::failed, "a pixel has more samples to come than it was given");
  }
  samples -= pending;
}

}  // namespace

std::uint32_t max_entries(std::uint32_t slice_samples) {
  return std::max(kMaxEntries, slice_samples / kMinSamplesOfEntry);
}

SliceParams next_slice(const Round& round, std::uint32_t slice_samples) {
  const SampleGroup& group = round.groups[round.group];
  const auto count = static_cast<std::uint32_t>(group.work.size());
  return {round.entry, std::min(entries_at_once(group, slice_samples), count - round.entry),
          round.sample,
          std::min(samples_at_once(group, slice_samples), group.samples - round.sample)};
}

void advance(Round& round, std::uint32_t slice_samples) {
  const SliceParams slice = next_slice(round, slice_samples);
  const SampleGroup& group = round.groups[round.group];
  round.sample += slice.sample_count;
  if (round.sample < group.samples) return;
  round.sample = 0;
  round.entry += slice.pixel_count;
  if (round.entry < group.work.size()) return;
  round.entry = 0;
  ++round.group;
}

std::vector<std::uint32_t> traced_samples(const Round& round, std::uint32_t slice_samples,
                                          const std::vector<std::uint32_t>& given) {
  std::vector<std::uint32_t> samples = given;
  for (std::size_t g = round.group; g < round.groups.size(); ++g) {
    const SampleGroup& group = round.groups[g];
    const bool begun = g == round.group;
    const std::size_t first = begun ? round.entry : 0;
    const std::size_t part_end = begun ? first + entries_at_once(group, slice_samples) : 0;
    for (std::size_t entry = first; entry < group.work.size(); ++entry)
      take_back(samples[group.work[entry].pixel],
                group.samples - (entry < part_end ? round.sample : 0));
  }
  return samples;
}

}  // namespace dapple
