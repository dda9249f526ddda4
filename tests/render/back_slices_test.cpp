// The points whose backs are traced are packed without gaps, and several slices are traced at once:
// which samples are chosen, where they go, and what may go together.
#include "render/back_slices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "sampling/round.hpp"

namespace dapple {
namespace {

constexpr uint kGroupBits = 2, kGroup = 4;
constexpr std::uint32_t kSliceSamples = 2048;

/// Entries of consecutive pixels.
std::vector<PixelWork> work_of(std::uint32_t pixels, std::uint32_t first_sample) {
  std::vector<PixelWork> work(pixels);
  for (std::uint32_t p = 0; p < pixels; ++p) work[p] = {p, first_sample};
  return work;
}

BackParams choice_of_four() {
  BackParams choice{};
  choice.group_bits = kGroupBits;
  choice.seed = 3;
  choice.width = choice.crop_width = 64;
  return choice;
}

TEST(BackSlices, AlignedSamplesAreInFewerGroupsThanOthers) {
  const std::vector<PixelWork> work = work_of(8, 8);
  const SliceParams slice{2, 4, 0, 8};
  EXPECT_EQ(groups_touched(slice, work, kGroupBits), 2u);
  EXPECT_EQ(groups_touched({2, 4, 3, 8}, work, kGroupBits), 3u);  // the last of a group before
  EXPECT_EQ(groups_touched({2, 4, 0, 5}, work, kGroupBits), 2u);
  EXPECT_EQ(groups_touched({2, 4, 4, 1}, work, kGroupBits), 1u);
  EXPECT_EQ(groups_touched(slice, work, 0), 8u);
  std::vector<PixelWork> one_differs = work;
  one_differs[3].first_sample = 9;
  EXPECT_EQ(groups_touched(slice, one_differs, kGroupBits), 3u);
  one_differs[7].first_sample = 9;  // not of the next slice
  EXPECT_EQ(groups_touched({4, 3, 0, 8}, one_differs, kGroupBits), 2u);
}

class BackSlicesOfDevice : public testing::Test {
 protected:
  BackSlicesOfDevice() {
    queues_.work = context_.allocate(64 * sizeof(PixelWork));
    backs_.emplace(context_, queues_, kSliceSamples, choice_of_four());
  }

  /// Surface points of a slice, of which every third sample missed. Positions tell them apart.
  void place_points(const SliceParams& slice, const std::vector<PixelWork>& work) {
    std::vector<SurfacePoint> points(samples_of(slice));
    std::vector<SampleHits> hits(hit_records(points.size()));
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const PixelWork& entry = work[slice.first_work + i / slice.sample_count];
      SurfacePoint& point = points[i];
      point.pixel = entry.pixel;
      point.sample = entry.first_sample + slice.first_sample + i % slice.sample_count;
      point.position[0] = static_cast<float>(point.pixel);
      point.position[1] = static_cast<float>(point.sample);
      point.normal[2] = 1;
      if ((point.pixel + point.sample) % 3 != 0)
        hits[i / DAPPLE_HIT_BITS].hits |= 1u << i % DAPPLE_HIT_BITS;
    }
    context_.write(queues_.work, work.data(), work.size() * sizeof(PixelWork));
    context_.write(queues_.points, points.data(), points.size() * sizeof(SurfacePoint));
    context_.write(queues_.sample_hits, hits.data(), hits.size() * sizeof(SampleHits));
  }

  /// The turned points that hit, in order.
  std::vector<SurfacePoint> turned() {
    const std::size_t samples = samples_of(packed_slice(backs_->choice()));
    std::vector<SurfacePoint> points(samples);
    std::vector<SampleHits> hits(hit_records(samples));
    context_.read(backs_->queues().points, points.data(), samples * sizeof(SurfacePoint));
    context_.read(backs_->queues().sample_hits, hits.data(), hits.size() * sizeof(SampleHits));
    std::vector<SurfacePoint> that_hit;
    for (std::size_t i = 0; i < samples; ++i)
      if (hits[i / DAPPLE_HIT_BITS].hits >> i % DAPPLE_HIT_BITS & 1u) that_hit.push_back(points[i]);
    return that_hit;
  }

  DeviceContext context_{"", "", Packets::none};
  Queues queues_ = make_queues(context_, kSliceSamples, 1);
  std::optional<BackSlices> backs_;
};

// Two slices of 16 pixels with 8 samples give 32 points each before misses.
TEST_F(BackSlicesOfDevice, SlicesThatFollowEachOtherArePackedInOrder) {
  const std::vector<PixelWork> work = work_of(32, 8);
  for (const std::uint32_t first : {0u, 16u}) {
    const SliceParams slice{first, 16, 0, 8};
    place_points(slice, work);
    ASSERT_TRUE(backs_->fits(slice, work));
    backs_->add(slice, work);
  }
  const SliceParams packed = packed_slice(backs_->choice());
  EXPECT_EQ(packed.pixel_count, 32u);
  EXPECT_EQ(packed.sample_count, 2u);
  std::vector<int> of_group(64);
  std::uint32_t before = 0;
  for (const SurfacePoint& point : turned()) {
    const std::uint32_t slot = point.pixel * 2 + point.sample - 2;  // groups 2 and 3 of each pixel
    EXPECT_GE(slot, before);
    before = slot;
    ++of_group.at(slot);
    EXPECT_EQ(point.position[0], static_cast<float>(point.pixel));
    EXPECT_EQ(static_cast<std::uint32_t>(point.position[1]) / kGroup, point.sample);
    EXPECT_EQ(point.normal[2], -1);
  }
  // One of each group, unless that sample missed.
  EXPECT_EQ(*std::max_element(of_group.begin(), of_group.end()), 1);
  EXPECT_NEAR(std::accumulate(of_group.begin(), of_group.end(), 0), 64 * 2 / 3, 8);
}

// Samples in three slices that cut through groups: each group's point comes in one of them.
TEST_F(BackSlicesOfDevice, CutGroupsHaveThePointsOfWholeOnes) {
  const std::vector<PixelWork> work = work_of(16, 0);
  const auto numbers = [&](const std::vector<SliceParams>& slices) {
    std::vector<std::pair<std::uint32_t, float>> found;  // pixel, sample
    for (const SliceParams& slice : slices) {
      place_points(slice, work);
      backs_->add(slice, work);
      for (const SurfacePoint& point : turned()) found.emplace_back(point.pixel, point.position[1]);
      backs_->clear();
    }
    std::sort(found.begin(), found.end());
    return found;
  };
  const auto whole = numbers({{0, 16, 0, 16}});
  EXPECT_GT(whole.size(), 30u);
  EXPECT_EQ(numbers({{0, 16, 0, 7}, {0, 16, 7, 6}, {0, 16, 13, 3}}), whole);
}

TEST_F(BackSlicesOfDevice, OnlySlicesOfTheSameSamplesInTheSameWorkGoTogether) {
  const std::vector<PixelWork> work = work_of(64, 0), other = work_of(64, 0);
  const SliceParams slice{0, 16, 0, 8};
  EXPECT_TRUE(backs_->fits(slice, work));
  backs_->add(slice, work);
  EXPECT_TRUE(backs_->fits({16, 16, 0, 8}, work));
  EXPECT_FALSE(backs_->fits({16, 16, 0, 8}, other));
  EXPECT_FALSE(backs_->fits({17, 16, 0, 8}, work));
  EXPECT_FALSE(backs_->fits({16, 16, 8, 8}, work));
  EXPECT_FALSE(backs_->fits({16, 16, 0, 4}, work));
  std::vector<PixelWork> unaligned = work;
  backs_->clear();
  backs_->add(slice, unaligned);
  unaligned[20].first_sample = 1;
  EXPECT_FALSE(backs_->fits({16, 16, 0, 8}, unaligned));
}

TEST_F(BackSlicesOfDevice, TogetherTheyFitTheQueuesAndBeginWithWholeRecords) {
  const std::vector<PixelWork> work = work_of(4096, 0);
  queues_.work = context_.allocate(4096 * sizeof(PixelWork));
  backs_.emplace(context_, queues_, kSliceSamples, choice_of_four());
  backs_->add({0, 512, 0, 4}, work);  // 512 points
  EXPECT_TRUE(backs_->fits({512, 1536, 0, 4}, work));
  EXPECT_FALSE(backs_->fits({512, 1537, 0, 4}, work));
  backs_->clear();
  backs_->add({0, 511, 0, 4}, work);  // not a multiple of 16
  EXPECT_FALSE(backs_->fits({511, 16, 0, 4}, work));
}

}  // namespace
}  // namespace dapple
