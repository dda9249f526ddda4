// Values of places from samples of both sides: which side counts, and how much.
#include "bake/samples/value_sums.hpp"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

namespace dapple {
namespace {

/// Samples that each count for one place.
class Samples {
 public:
  /// `front`, `back`: AO; below 0: not traced.
  void add(std::uint32_t place, float front, float back, bool inside = false) {
    SurfaceSample sample;
    sample.place = {place, place, place};
    sample.weight = {1, 0, 0};
    sample.front = front >= 0;
    sample.back = back >= 0;
    samples_.push_back(sample);
    found_.front.push_back({front, V3f(0, 0, 0)});
    found_.back.push_back({back, V3f(0, 0, 0)});
    found_.inside.push_back(inside ? 1 : 0);
  }
  void add_to(ValueSums& sums) const { sums.add(samples_, found_); }

 private:
  std::vector<SurfaceSample> samples_;
  TracedSamples found_;
};

SmallParts one_part(std::size_t places) { return {std::vector<std::uint32_t>(places, 0), 1}; }

// Its first sample lay inside of a twig, after which only the brighter side of its leaf was traced.
TEST(ValueSums, APlaceWithSamplesOfOneSideHasTheirMean) {
  for (const bool back : {false, true}) {
    Samples samples;
    samples.add(0, 0.5f, 0.5f, true);
    for (int i = 0; i < 4; ++i) samples.add(0, back ? -1 : 0.25f, back ? 0.25f : -1);
    for (int i = 0; i < 20; ++i) samples.add(1, back ? 0.1f : 0.9f, back ? 0.9f : 0.1f);
    ValueSums sums(one_part(2), BakeSides::max);
    samples.add_to(sums);
    sums.choose_sides();
    const std::vector<PlaceValue> values = sums.values();
    EXPECT_TRUE(values[0].known);
    EXPECT_TRUE(sums.has_inside(0));
    EXPECT_NEAR(values[0].ao, 0.25f, 1e-6f);
    EXPECT_NEAR(values[1].ao, 0.9f, 1e-6f);
  }
}

TEST(ValueSums, PlacesOfACardDifferByTheirContrast) {
  Samples samples;
  for (const auto& [place, value] : {std::pair{0u, 0.2f}, {1u, 0.4f}, {2u, 0.9f}})
    for (int i = 0; i < 8; ++i) samples.add(place, value, -1);
  for (const bool is_card : {false, true}) {
    SmallParts parts = one_part(3);
    if (!is_card) parts = {std::vector<std::uint32_t>(3, SmallParts::kLarge), 0};
    ValueSums sums(parts, BakeSides::front);
    samples.add_to(sums);
    sums.choose_sides();
    EXPECT_NEAR(sums.values()[2].ao, 0.9f, 1e-6f);
    sums.set_contrast(0.5f);
    const std::vector<PlaceValue> values = sums.values();
    EXPECT_NEAR(values[0].ao, is_card ? 0.35f : 0.2f, 1e-6f);
    EXPECT_NEAR(values[1].ao, is_card ? 0.45f : 0.4f, 1e-6f);
    EXPECT_NEAR(values[2].ao, is_card ? 0.7f : 0.9f, 1e-6f);
  }
}

TEST(ValueSums, ErrorsOfACardDifferByTheSquareOfItsContrast) {
  Samples samples;
  for (const auto& [place, count] : {std::pair{0u, 2}, {1u, 8}, {2u, 32}})
    for (int i = 0; i < count; ++i) samples.add(place, i % 2 ? 0.4f : 0.6f, -1);
  ValueSums sums(one_part(3), BakeSides::front);
  samples.add_to(sums);
  sums.choose_sides();
  const std::vector<float> own = sums.squared_errors();
  sums.set_contrast(0.5f);
  const std::vector<float> moved = sums.squared_errors();
  const float mean = (own[0] + own[1] + own[2]) / 3;
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_FLOAT_EQ(own[i], sums.squared_noise(i));
    EXPECT_NEAR(moved[i], mean + 0.25f * (own[i] - mean), 1e-8f);
  }
  EXPECT_GT(own[0], 3 * own[1]);
}

TEST(ValueSums, PlacesThatSeeNothingGetEightSamples) {
  Samples samples;
  for (const auto& [place, ao, count] :
       {std::tuple{0u, 0.0f, 2}, {1u, 0.0f, 8}, {2u, 0.3f, 2}, {3u, 0.0f, 16}})
    for (int i = 0; i < count; ++i) samples.add(place, ao, -1);
  for (int i = 0; i < 4; ++i) samples.add(4, 0, -1, true);
  ValueSums sums({std::vector<std::uint32_t>(6, SmallParts::kLarge), 0}, BakeSides::front);
  samples.add_to(sums);
  sums.choose_sides();
  const std::vector<float> expected{4, 1, 1, 1, 2, 1};  // the last has no samples
  EXPECT_EQ(sums.missing_samples(1), expected);
}

// One sees nothing, as in a closed room.
TEST(ValueSums, DarkPlacesOfACardStayDark) {
  Samples samples;
  for (int i = 0; i < 8; ++i) {
    samples.add(0, 0, -1);
    samples.add(1, 0.5f, -1);
  }
  ValueSums sums(one_part(2), BakeSides::front);
  samples.add_to(sums);
  sums.choose_sides();
  sums.set_contrast(0.5f);
  EXPECT_EQ(sums.values()[0].ao, 0);
  EXPECT_EQ(sums.values()[1].ao, 0.5f);
}

TEST(ValueSums, APlaceWithoutSamplesIsUnoccluded) {
  ValueSums sums(one_part(1), BakeSides::max);
  sums.choose_sides();
  EXPECT_EQ(sums.values()[0].ao, 1);
}

TEST(ValueSums, BentNormalsOfBothSidesAreTheFrontsWhereTheyCancel) {
  for (const float back : {1.0f, 0.3f}) {
    std::vector<SurfaceSample> samples(1);
    samples[0].back = true;
    samples[0].weight = {1, 0, 0};
    TracedSamples found;
    found.front = {{1, V3f(0, 0.9f, 0.02f)}};
    found.back = {{back, V3f(0.9f * back, -0.9f * back, 0)}};
    if (back == 1) found.back[0].bent.x = 0.02f;  // noise
    ValueSums sums(one_part(1), BakeSides::mean);
    sums.add(samples, found);
    sums.choose_sides();
    const V3f bent = sums.values()[0].bent;
    const V3f expected = back == 1 ? found.front[0].bent : found.front[0].bent + found.back[0].bent;
    EXPECT_TRUE(bent.equalWithAbsError(expected.normalized(), 1e-5f)) << bent;
  }
}

// Samples are added where values are uncertain, which must not decide for the whole leaf.
TEST(ValueSums, PlacesOfAPartCountTheSameHoweverManySamplesTheyHave) {
  Samples samples;
  for (int i = 0; i < 40; ++i) samples.add(0, 0.9f, 0.1f);
  for (int i = 0; i < 4000; ++i) samples.add(1, 0.2f, 0.5f);
  ValueSums sums(one_part(2), BakeSides::max);
  samples.add_to(sums);
  sums.choose_sides();
  EXPECT_FALSE(sums.is_wanted(0, true));
  EXPECT_FALSE(sums.is_wanted(1, true));
  EXPECT_NEAR(sums.values()[0].ao, 0.9f, 1e-5f);
  EXPECT_NEAR(sums.values()[1].ao, 0.2f, 1e-5f);
}

/// A place of no small part, with eight samples of each side.
ValueSums single_place(float front, float back) {
  Samples samples;
  for (int i = 0; i < 8; ++i) {
    const float noise = i % 2 ? 0.2f : -0.2f;
    samples.add(0, front + noise, back - noise);
  }
  ValueSums sums({{SmallParts::kLarge}, 0}, BakeSides::max);
  samples.add_to(sums);
  return sums;
}

TEST(ValueSums, TheDarkerSideIsWantedWhileThatItIsMattersForTheTarget) {
  for (const bool back : {false, true}) {
    ValueSums sums = back ? single_place(0.4f, 0.5f) : single_place(0.5f, 0.4f);
    for (const float target : {0.0f, 0.02f, 0.2f}) {
      sums.choose_sides(target);
      EXPECT_TRUE(sums.is_wanted(0, back));
      EXPECT_EQ(sums.is_wanted(0, !back), target < 0.1f) << target;
    }
  }
}

// Noise e^2 / 4 of a mean of both, where e^2 is that of their difference, half of which is regret.
TEST(ValueSums, ErrorsContainTheRegretOfNotKnowingTheBrighterSide) {
  ValueSums sums = single_place(0.5f, 0.5f);
  sums.choose_sides();
  EXPECT_NEAR(sums.squared_errors()[0] / sums.squared_noise(0), 3, 1e-4f);
  sums.set_noise_ratio(0.5f);
  EXPECT_NEAR(sums.squared_errors()[0] / sums.squared_noise(0), 2.5f, 1e-4f);
  ValueSums sure = single_place(0.9f, 0.1f);
  sure.choose_sides();
  EXPECT_NEAR(sure.squared_errors()[0] / sure.squared_noise(0), 1, 1e-4f);
}

TEST(ValueSums, WhereNeitherSideIsSurelyBrighterTheLikelierCountsMore) {
  float before = 0.5f;
  for (const float back : {0.5f, 0.54f, 0.58f, 0.62f}) {
    ValueSums sums = single_place(0.5f, back);
    sums.choose_sides();
    const float ao = sums.values()[0].ao;
    EXPECT_TRUE(sums.is_wanted(0, false) && sums.is_wanted(0, true)) << back;
    EXPECT_LE(ao, back);
    EXPECT_GE(ao, 0.5f * (0.5f + back)) << "the mean";
    EXPECT_GE(ao, before);
    before = ao;
  }
  EXPECT_GT(before, 0.57f);
}

TEST(ValueSums, WithoutAChoiceBothSidesCountTheSame) {
  Samples samples;
  for (int i = 0; i < 100; ++i) samples.add(0, 0.9f, 0.3f);
  ValueSums sums(one_part(1), BakeSides::mean);
  samples.add_to(sums);
  sums.choose_sides();
  EXPECT_NEAR(sums.values()[0].ao, 0.6f, 1e-5f);
}

}  // namespace
}  // namespace dapple
