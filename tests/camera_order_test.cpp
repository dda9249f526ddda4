// The samples of one camera item are taken in an order in which sixteen in a row lie together, and
// sums are rounded as OpenCL's own saturating conversion does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

constexpr std::size_t kItem = 64, kBeam = 16;

struct Places {
  std::vector<float> x, y;
};

std::vector<uint> order_of(const Places& places) {
  const Buffer x = upload(places.x), y = upload(places.y);
  const Buffer order = device().allocate(kItem * sizeof(uint));
  run("film_and_camera", "camera_order", 1, {x, y, order});
  return download<uint>(order, kItem);
}

/// Samples on a grid of cells, row by row, from (left, top) on, each in the middle of its cell.
Places grid(int columns, float left, float top, float cell) {
  Places places;
  for (std::size_t i = 0; i < kItem; ++i) {
    places.x.push_back(left + (static_cast<float>(i % columns) + 0.5f) * cell);
    places.y.push_back(top + (static_cast<float>(i / columns) + 0.5f) * cell);
  }
  return places;
}

/// Sides of the box around the widest beam.
std::pair<float, float> widest(const Places& places, const std::vector<uint>& order) {
  std::pair<float, float> widest{0, 0};
  for (std::size_t beam = 0; beam < kItem; beam += kBeam) {
    const auto side = [&](const std::vector<float>& at) {
      float low = at[order[beam]], high = low;
      for (std::size_t i = beam; i < beam + kBeam; ++i) {
        low = std::min(low, at[order[i]]);
        high = std::max(high, at[order[i]]);
      }
      return high - low;
    };
    widest = {std::max(widest.first, side(places.x)), std::max(widest.second, side(places.y))};
  }
  return widest;
}

TEST(CameraOrder, EachSampleIsTakenOnce) {
  for (const Places& places :
       {grid(8, 16, 8, 1), grid(64, 3, 5, 1.0f / 64), grid(4, 250, 300, 0.7f),
        Places{std::vector<float>(kItem, 7.5f), std::vector<float>(kItem, 1.0f)}}) {
    const std::vector<uint> order = order_of(places);
    EXPECT_EQ(std::set<uint>(order.begin(), order.end()).size(), kItem);
    EXPECT_LT(*std::max_element(order.begin(), order.end()), kItem);
  }
}

TEST(CameraOrder, SixteenInARowFillASquareOfATileAndAQuarterOfAPixel) {
  for (const float cell : {1.0f, 1.0f / 8}) {
    const Places places = grid(8, 24, 16, cell);
    const auto [width, height] = widest(places, order_of(places));
    EXPECT_FLOAT_EQ(width, 3 * cell);
    EXPECT_FLOAT_EQ(height, 3 * cell);
  }
}

TEST(FixedPoints, RoundToEvenSaturateAndTakeNanAsZero) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values{0.5f,          1.5f,       2.5f,  -0.5f,      -1.5f,     1e18f,
                                  -3e18f,        8388607.5f, 1e30f, -kInfinity, kInfinity, -1e30f,
                                  std::nanf(""), 0.0f,       0.25f, -7.75f};
  const Buffer in = upload(values);
  const Buffer out = device().allocate(values.size() * sizeof(std::int64_t));
  const auto items = static_cast<uint>(values.size() / 8);
  run("film_and_camera", "to_fixed_points", items, {in, out, items});
  const auto sums = download<std::int64_t>(out, values.size());
  // The greatest float below 2^63.
  constexpr std::int64_t kMost = 9223371487098961920;
  const std::vector<std::int64_t> expected{0,
                                           2,
                                           2,
                                           0,
                                           -2,
                                           static_cast<std::int64_t>(1e18f),
                                           static_cast<std::int64_t>(-3e18f),
                                           8388608,
                                           kMost,
                                           -kMost,
                                           kMost,
                                           -kMost,
                                           0,
                                           0,
                                           0,
                                           -8};
  EXPECT_EQ(sums, expected);
}

}  // namespace
}  // namespace dapple
