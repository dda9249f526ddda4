// Comparing films: figures against closed forms and brute force, effects of NaN and infinity, when
// a comparison passes, and the heat map.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "compare/heat_map.hpp"
#include "compare/worst_window.hpp"
#include "support/compare_films.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace compare_test;
using Names = std::vector<std::string>;

// The difference of two films of one channel.
LayerDifference difference(const std::string& channel, int width, int height,
                           const std::vector<float>& a, const std::vector<float>& b) {
  return compared(film_of(width, height, {{channel, a}}), film_of(width, height, {{channel, b}}))
      .layers.at(0);
}

Names layer_names(const Comparison& c) {
  Names names;
  for (const LayerDifference& layer : c.layers) names.push_back(layer.layer);
  return names;
}

TEST(CompareLayers, AreWhatPrecedesTheLastDotAndAreMatchedByName) {
  EXPECT_EQ(layer_of("light.key.R"), "light.key");
  EXPECT_EQ(layer_of("Z"), "Z");
  EXPECT_EQ(layer_of("A"), "RGBA");
  const auto film = [](const Names& channels) {
    std::vector<Plane> planes;
    for (const std::string& channel : channels) planes.push_back({channel, {1}});
    return film_of(1, 1, planes);
  };
  const Comparison c = compared(film({"A", "N.X", "R", "Z", "ao.G", "ao.R", "bent.X"}),
                                film({"N.X", "P.X", "P.Y", "R", "ao.R", "bent.R"}));
  EXPECT_EQ(layer_names(c), (Names{"RGBA", "N", "ao"}));
  EXPECT_EQ(c.only_a, (Names{"A", "Z", "ao.G", "bent"}));
  EXPECT_EQ(c.only_b, (Names{"bent", "P"}));
  EXPECT_EQ(c.layers[2].values, 1U);
}

TEST(CompareFigures, AreZeroForEqualFilms) {
  const Film film = film_of(9, 7, {{"ao.R", noise(63, 1)}, {"light.key.R", noise(63, 2)}});
  for (const LayerDifference& d : compared(film, film).layers) {
    EXPECT_EQ(d.values, 63U);
    EXPECT_EQ(d.mean_a, d.mean_b);
    for (const double zero : {d.mean_difference, d.rmse, d.relative_mse, d.max_difference,
                              d.window_rmse, d.rmse_of_largest.value_or(0)}) {
      EXPECT_EQ(zero, 0.0) << d.layer;
    }
  }
  EXPECT_EQ(failure(compared(film, film), 0.0), "");
}

// All values are sums of few powers of two, so sums are exact in doubles, and so are the closed
// forms.
TEST(CompareFigures, OfAConstantOffsetAreThatOffset) {
  const LayerDifference d = difference("ao.R", 40, 50, constant(2000, 0.75f), constant(2000, 0.5f));
  EXPECT_EQ(d.mean_a, 0.75);
  EXPECT_EQ(d.mean_b, 0.5);
  EXPECT_EQ(d.mean_difference, 0.25);
  EXPECT_EQ(d.rmse, 0.25);
  EXPECT_EQ(d.max_difference, 0.25);
  EXPECT_EQ(d.window_rmse, 0.25);
  EXPECT_NEAR(d.relative_mse, 0.0625 / (0.25 + 0.01), 1e-12);
  EXPECT_FALSE(d.rmse_of_largest.has_value());
}

TEST(CompareFigures, SeparateMeanDifferenceFromRmseAndFindTheLargest) {
  // The differences are -0.5, 0.5, 0 and 1; the largest is in the second row.
  const LayerDifference d = difference("ao.R", 2, 2, {0, 1, 0.25f, 1}, {0.5f, 0.5f, 0.25f, 0});
  EXPECT_EQ(d.mean_difference, 0.25);
  EXPECT_EQ(d.rmse, std::sqrt(1.5 / 4));
  EXPECT_EQ(d.max_difference, 1.0);
  EXPECT_EQ(d.max_channel, "ao.R");
  EXPECT_EQ(d.max_x, 11);
  EXPECT_EQ(d.max_y, 21);
}

TEST(CompareFigures, OfLightsAreAlsoRelativeToTheLargestValueInB) {
  const LayerDifference d = difference("light.key.R", 2, 1, {3, 9}, {2, 8});
  EXPECT_EQ(d.rmse, 1.0);
  EXPECT_EQ(d.rmse_of_largest, 0.125);
  EXPECT_FALSE(difference("light.key.R", 1, 1, {1}, {0}).rmse_of_largest.has_value());
}

TEST(CompareFigures, CountInfinityAndNanApartAndLeaveThemOut) {
  // Equal infinities; infinity against 1 and against -infinity; NaN in a, in b and in both.
  const std::vector<float> a{kInfinity, kInfinity, -kInfinity, kNan, 1, kNan, 3};
  const std::vector<float> b{kInfinity, 1, kInfinity, 1, kNan, kNan, 1};
  const LayerDifference d = difference("Z", 7, 1, a, b);
  EXPECT_EQ(d.values, 1U);
  EXPECT_EQ(d.infinity_mismatches, 2U);
  EXPECT_EQ(d.nans, 3U);
  EXPECT_EQ(d.mean_a, 3.0);
  EXPECT_EQ(d.rmse, 2.0);
  EXPECT_EQ(d.max_x, 16);
  const LayerDifference sky =
      difference("Z", 2, 1, {kInfinity, -kInfinity}, {kInfinity, -kInfinity});
  EXPECT_EQ(sky.values + sky.infinity_mismatches + sky.nans, 0U);
  EXPECT_EQ(sky.rmse, 0.0);
}

TEST(CompareWindow, HoldsThePatchThatDiffers) {
  constexpr int kWidth = 100, kHeight = 70;
  const std::vector<float> b = constant(kWidth * kHeight, 0.5f);
  std::vector<float> a = b;
  for (int y = 40; y < 48; ++y) {
    for (int x = 60; x < 68; ++x) a[static_cast<std::size_t>(y * kWidth + x)] = 1.0f;
  }
  const LayerDifference d = difference("ao.R", kWidth, kHeight, a, b);
  EXPECT_EQ(d.window.width(), 32);
  EXPECT_EQ(d.window.height(), 32);
  EXPECT_TRUE(d.window.x0 <= 70 && d.window.x1 >= 77) << d.window.x0;
  EXPECT_TRUE(d.window.y0 <= 60 && d.window.y1 >= 67) << d.window.y0;
  EXPECT_DOUBLE_EQ(d.window_rmse, 0.5 * std::sqrt(64.0 / 1024));
}

TEST(CompareWindow, IsTheLargestOfAllByBruteForce) {
  constexpr int kWidth = 45, kHeight = 37;
  const std::vector<float> random = noise(kWidth * kHeight, 7);
  const std::vector<double> squared(random.begin(), random.end());
  const auto sum = [&](int x0, int y0) {
    double total = 0;
    for (int y = y0; y < y0 + 32; ++y) {
      for (int x = x0; x < x0 + 32; ++x) total += squared[static_cast<std::size_t>(y * kWidth + x)];
    }
    return total;
  };
  double largest = 0;
  for (int y = 0; y + 32 <= kHeight; ++y) {
    for (int x = 0; x + 32 <= kWidth; ++x) largest = std::max(largest, sum(x, y));
  }
  const WorstWindow worst = find_worst_window(squared, kWidth, kHeight);
  // 1665 additions of numbers up to about 830: rounding stays below 1665 * 830 * 2^-53 < 2e-10.
  EXPECT_NEAR(worst.sum, largest, 1e-9);
  EXPECT_NEAR(sum(worst.rect.x0, worst.rect.y0), largest, 1e-9);
  EXPECT_EQ(find_worst_window({1, 2, 3}, 3, 1).rect, (PixelRect{0, 0, 2, 0}));
  std::vector<double> corner(kWidth * kHeight, 0.0);
  corner.back() = 1.0;
  EXPECT_EQ(find_worst_window(corner, kWidth, kHeight).rect, (PixelRect{13, 5, 44, 36}));
}

TEST(CompareFailure, NamesLayerAndFigureAndExemptsDistancesAndCounts) {
  const std::vector<float> b = constant(4, 1);
  const Film film_b =
      film_of(2, 2, {{"Z", b}, {"ao.R", b}, {"samples", b}, {"motion.X", b}, {"visits.nodes", b}});
  const std::vector<float> far = constant(4, 9);
  const Film film_a = film_of(2, 2,
                              {{"Z", far},
                               {"ao.R", constant(4, 1.25f)},
                               {"samples", far},
                               {"motion.X", far},
                               {"visits.nodes", far}});
  const Comparison c = compared(film_a, film_b);
  EXPECT_EQ(failure(c, std::nullopt), "");
  EXPECT_EQ(failure(c, 0.25), "");
  EXPECT_EQ(failure(c, 0.2), "a.exr and b.exr differ: layer ao has RMSE 0.25; --max-rmse is 0.2");
  Comparison only_z = c;
  only_z.layers.resize(1);
  ASSERT_EQ(only_z.layers[0].layer, "Z");
  EXPECT_TRUE(contains(failure(only_z, 0.2), "layer Z has RMSE 8"));
}

TEST(CompareFailure, UnderALimitNamesTheLayersThatTheFirstFilmLacks) {
  const std::vector<Plane> planes = {
      {"Z", {1}}, {"ao.R", {1}}, {"ao.back.R", {1}}, {"light.key.R", {1}}, {"motion.X", {1}}};
  const Film all = film_of(1, 1, planes);
  const Film ao = film_of(1, 1, {planes[1]});
  EXPECT_EQ(failure(compared(ao, all), std::nullopt), "");
  EXPECT_EQ(failure(compared(ao, all), 0.5),
            "a.exr and b.exr differ: ao.back is only in b.exr; light.key is only in b.exr; "
            "--max-rmse is 0.5");
  EXPECT_EQ(failure(compared(all, ao), 0.5), "");
}

TEST(CompareFailure, NanAlwaysFailsAndInfinityFailsUnderALimit) {
  const auto one = [](const std::string& channel, float a, float b) {
    return compared(film_of(1, 1, {{channel, {a}}}), film_of(1, 1, {{channel, {b}}}));
  };
  EXPECT_TRUE(contains(failure(one("Z", kNan, kNan), std::nullopt), "layer Z has 1 NaN"));
  EXPECT_EQ(failure(one("ao.R", kInfinity, 1), std::nullopt), "");
  EXPECT_TRUE(contains(failure(one("ao.R", kInfinity, 1), 100), "layer ao has 1 infinities"));
  EXPECT_EQ(failure(one("ao.R", kInfinity, kInfinity), 0.0), "");
}

TEST(CompareWindows, ThatDifferAreRefusedWithBothSizes) {
  const Film a = film_of(4, 2, {{"Z", constant(8, 1)}});
  Film b = film_of(3, 2, {{"Z", constant(6, 1)}});
  const Error sizes = error_of([&] { require_same_windows(a, b, "a.exr", "b.exr"); });
  EXPECT_EQ(sizes.kind(), ErrorKind::input);
  EXPECT_TRUE(contains(sizes.what(), "4 x 2 pixels")) << sizes.what();
  EXPECT_TRUE(contains(sizes.what(), "3 x 2 pixels")) << sizes.what();
  b = a;
  b.data_window.x0 += 1;
  b.data_window.x1 += 1;
  EXPECT_EQ(error_of([&] { require_same_windows(a, b, "a", "b"); }).kind(), ErrorKind::input);
  b = a;
  b.height += 1;
  EXPECT_EQ(error_of([&] { require_same_windows(a, b, "a", "b"); }).kind(), ErrorKind::input);
  EXPECT_NO_THROW(require_same_windows(a, a, "a", "a"));
}

// CIE luminance Y of an sRGB colour; lightness increases with it.
double luminance(const Rgb& color) {
  const auto linear = [](std::uint8_t code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

TEST(HeatMap, GetsLighterWithTheDifferenceAndGreenWithoutOne) {
  for (int i = 1; i <= 100; ++i) {
    EXPECT_GT(luminance(heat_color(i / 100.0)), luminance(heat_color((i - 1) / 100.0))) << i;
  }
  EXPECT_EQ(heat_color(-1), kHeatRamp.front());
  EXPECT_EQ(heat_color(1e30), kHeatRamp.back());
  EXPECT_EQ(heat_color(0.5 / 15), (Rgb{6, 5, 20}));  // rounded mean of (0, 0, 4) and (11, 9, 36)

  // The pixels: equal, half of the range in each of the two channels, the whole range, beyond it,
  // NaN against a number, equal infinities.
  const std::vector<float> one{1, 1, 1, 1, 1, 1, kInfinity};
  const Film a = film_of(7, 1,
                         {{"ao.G", {1, 0.5f, 0.75f, 2, 9, kNan, kInfinity}},
                          {"ao.R", {1, 1, 1.5f, 1, 1, 2, kInfinity}}});
  const Film b = film_of(7, 1, {{"ao.G", one}, {"ao.R", one}});
  const LayerMatch match = match_layers(a, b);
  const ByteImage map = heat_map(match.pairs.at(0), a.data_window, 1.0);
  const Rgb cold = kHeatRamp.front(), hot = kHeatRamp.back();
  std::vector<std::uint8_t> expected;
  const Rgb half = heat_color(0.5);
  for (const Rgb& color : {cold, half, half, hot, hot, kNoNumberColor, cold}) {
    expected.insert(expected.end(), color.begin(), color.end());
  }
  EXPECT_EQ(map.bytes, expected);
}

TEST(HeatMap, IsScaledByTheRangeThatPreviewsShow) {
  const Film film =
      film_of(2, 1, {{"N.X", {0, 1}}, {"Z", {10, 30}}, {"ao.R", {0, 1}}, {"light.key.R", {0, 8}}});
  const auto hottest = [&](const std::string& layer) {
    return hottest_difference(layer_tone(film, layer), 4);
  };
  EXPECT_EQ(hottest("ao.R"), 0.25);
  EXPECT_EQ(hottest("light.key.R"), 2.0);
  EXPECT_NEAR(hottest("Z"), 5.0, 1e-6);  // 1 / 20 is rounded to a float
}

}  // namespace
}  // namespace dapple
