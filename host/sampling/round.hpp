// A round of work: groups of pixels that get samples, and the position up to which they are traced.
// In: groups from the sample plan. Out: slices for the device. The next round is planned once a
// round is complete; renders can stop between slices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/shared/pass_params.h"

namespace dapple {

/// Pixels that get the same number of samples.
struct SampleGroup {
  std::uint32_t samples = 0;
  std::vector<PixelWork>
      work;  ///< tile by tile, so that pixels that are traced together are adjacent
};

struct Round {
  std::vector<SampleGroup> groups;  ///< to be traced in this order
  std::uint32_t group = 0;          ///< start of the next slice: group, entry of its work, and
  std::uint32_t entry = 0;          ///< sample, counted from the entry's own first
  std::uint32_t sample = 0;

  [[nodiscard]] bool is_done() const { return group >= groups.size(); }
};

/// Number of samples of a slice.
inline std::size_t samples_of(const SliceParams& slice) {
  return std::size_t{slice.pixel_count} * slice.sample_count;
}

/// Maximum number of pixels in a slice.
std::uint32_t max_entries(std::uint32_t slice_samples);

/// The next slice of a round that is not done, with at most `slice_samples` (a batch or more)
/// samples. Depends on nothing else, so that a render can continue on another machine.
SliceParams next_slice(const Round& round, std::uint32_t slice_samples);

/// Advances the round beyond next_slice().
void advance(Round& round, std::uint32_t slice_samples);

/// Number of traced samples of each pixel. `given` includes all samples of the round. Throws Error
/// failed if the round has more samples than were given.
std::vector<std::uint32_t> traced_samples(const Round& round, std::uint32_t slice_samples,
                                          const std::vector<std::uint32_t>& given);

}  // namespace dapple
