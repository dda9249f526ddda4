// How a round of work is divided into slices, and which samples are traced when it stops between
// two of them.
#include "sampling/round.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "dapple/error.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kPixels = 10;

/// Ten pixels with `samples` each; the first five have four more in a second group.
Round two_groups(std::uint32_t samples) {
  Round round;
  round.groups.resize(2);
  round.groups[0].samples = samples;
  round.groups[1].samples = 4;
  for (std::uint32_t p = 0; p < kPixels; ++p) round.groups[0].work.push_back({p, 0});
  for (std::uint32_t p = 0; p < 5; ++p) round.groups[1].work.push_back({p, samples});
  return round;
}

std::vector<std::uint32_t> given(std::uint32_t samples) {
  std::vector<std::uint32_t> all(kPixels, samples);
  for (std::uint32_t p = 0; p < 5; ++p) all[p] += 4;
  return all;
}

// Slices of 7 and 12 samples divide pixels and batches unevenly; 64 holds several pixels; 1000
// holds all.
TEST(Round, EverySampleIsTracedOnceInOrderAndCountedWhereverARoundStops) {
  for (const std::uint32_t samples : {3u, 16u, 50u}) {
    for (const std::uint32_t slice_samples : {7u, 12u, 64u, 1000u}) {
      Round round = two_groups(samples);
      std::vector<std::uint32_t> traced(kPixels, 0);
      while (!round.is_done()) {
        EXPECT_EQ(traced_samples(round, slice_samples, given(samples)), traced);
        const SliceParams slice = next_slice(round, slice_samples);
        EXPECT_LE(slice.pixel_count * slice.sample_count, slice_samples);
        EXPECT_GT(slice.pixel_count * slice.sample_count, 0u);
        const SampleGroup& group = round.groups[round.group];
        const bool ends = slice.first_sample + slice.sample_count == group.samples;
        const std::uint32_t whole = slice_samples < 2 * DAPPLE_SAMPLE_BATCH ? 1 : 2;
        EXPECT_TRUE(ends || slice.sample_count % (whole * DAPPLE_SAMPLE_BATCH) == 0)
            << "batches, or pairs";
        for (std::uint32_t i = 0; i < slice.pixel_count; ++i) {
          const PixelWork& work = group.work[slice.first_work + i];
          EXPECT_EQ(traced[work.pixel], work.first_sample + slice.first_sample);
          traced[work.pixel] += slice.sample_count;
        }
        advance(round, slice_samples);
      }
      EXPECT_EQ(traced, given(samples));
      EXPECT_EQ(traced_samples(round, slice_samples, given(samples)), traced);
    }
  }
}

TEST(Round, WithoutGroupsIsDone) {
  EXPECT_TRUE(Round{}.is_done());
  EXPECT_EQ(traced_samples({}, 64, {1, 2}), (std::vector<std::uint32_t>{1, 2}));
}

TEST(Round, MoreWorkThanGivenSamplesIsRefused) {
  EXPECT_THROW(traced_samples(two_groups(8), 64, std::vector<std::uint32_t>(kPixels, 8)), Error);
}

}  // namespace
}  // namespace dapple
