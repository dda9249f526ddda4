// Sampling functions of the kernels: Sobol points must be (0,2)-nets, and mappings must keep areas
// and solid angles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "dapple/shared/pass_params.h"
#include "support/random_direction.hpp"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

constexpr double kPi = std::numbers::pi;

std::vector<V2f> sobol_points(uint pixel, uint pair, uint seed, uint first, uint count) {
  const Buffer points = device().allocate(count * sizeof(V2f));
  run("sampling", "sobol_points", count, {points, pixel, pair, seed, first, count});
  return download<V2f>(points, count);
}

/// Whether each box of 2^-a by 2^-(k - a), for every a, holds exactly one of the 2^k points.
bool is_net(const std::vector<V2f>& points) {
  const auto k = static_cast<int>(std::lround(std::log2(points.size())));
  for (int a = 0; a <= k; ++a) {
    std::set<std::pair<int, int>> boxes;
    for (const V2f& p : points) {
      boxes.emplace(static_cast<int>(std::ldexp(p.x, a)), static_cast<int>(std::ldexp(p.y, k - a)));
    }
    if (boxes.size() != points.size()) return false;
  }
  return true;
}

bool in_unit_square(const std::vector<V2f>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](const V2f& p) { return p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1; });
}

TEST(Sampling, APixelsPointsAreNetsInEveryAlignedBlock) {
  for (const auto& [pixel, pair, seed] :
       {std::tuple{0u, 0u, 0u}, {1u, 1u, 0u}, {518399u, 2u, 7u}, {4294836224u, 9u, 0xffffffffu}}) {
    const auto points = sobol_points(pixel, pair, seed, 0, 1024);
    EXPECT_TRUE(in_unit_square(points));
    for (std::size_t size = 2; size <= points.size(); size *= 2) {
      for (std::size_t first = 0; first < points.size(); first += size) {
        EXPECT_TRUE(is_net({points.begin() + first, points.begin() + first + size}))
            << size << " points from " << first << " of pixel " << pixel;
      }
    }
    // Also far into the sequence, where a render takes its points when it continues.
    EXPECT_TRUE(is_net(sobol_points(pixel, pair, seed, 1u << 20, 256)));
  }
}

TEST(Sampling, PixelsPairsAndSeedsHaveUnrelatedPoints) {
  const auto base = sobol_points(5, 0, 1, 0, 4096);
  for (const auto& [pixel, pair, seed] : {std::tuple{6u, 0u, 1u}, {5u, 1u, 1u}, {5u, 0u, 2u}}) {
    const auto other = sobol_points(pixel, pair, seed, 0, 4096);
    double xx = 0, yy = 0;
    for (std::size_t i = 0; i < base.size(); ++i) {
      xx += (base[i].x - 0.5) * (other[i].x - 0.5) * 12;
      yy += (base[i].y - 0.5) * (other[i].y - 0.5) * 12;
    }
    // The correlation of 4,096 independent pairs has a standard deviation of 1/64; five are
    // allowed.
    EXPECT_LT(std::fabs(xx / 4096), 5.0 / 64);
    EXPECT_LT(std::fabs(yy / 4096), 5.0 / 64);
  }
}

TEST(Sampling, TheFirstPointOverPixelsIsUniform) {
  // A picture of one sample a pixel: 2,048 pixels, whose points are counted in 64 boxes.
  std::vector<int> boxes(64, 0);
  for (uint pixel = 0; pixel < 2048; ++pixel) {
    const V2f p = sobol_points(pixel, 1, 0, 0, 1)[0];
    ++boxes[static_cast<std::size_t>(static_cast<int>(p.x * 8) * 8 + static_cast<int>(p.y * 8))];
  }
  double chi_square = 0;
  for (const int count : boxes) chi_square += (count - 32.0) * (count - 32.0) / 32;
  // The mean is 63 and the standard deviation sqrt(126) = 11; five are allowed.
  EXPECT_LT(chi_square, 63 + 56);
}

std::vector<V2f> square_grid(int side) {
  std::vector<V2f> squares;
  for (int i = 0; i < side * side; ++i) {
    squares.push_back({(static_cast<float>(i % side) + 0.5f) / static_cast<float>(side),
                       (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side)});
  }
  return squares;
}

std::vector<V2f> disk_points(const std::vector<V2f>& squares) {
  const Buffer disk = device().allocate(squares.size() * sizeof(V2f));
  run("sampling", "disk_points", squares.size(),
      {upload(squares), disk, static_cast<uint>(squares.size())});
  return download<V2f>(disk, squares.size());
}

TEST(Sampling, TheConcentricMapKeepsAreas) {
  const int side = 256;
  double moments[5] = {};
  for (const V2f& p : disk_points(square_grid(side))) {
    const double x = p.x, y = p.y, square = x * x + y * y;
    EXPECT_LE(square, 1 + 1e-6);
    const double values[5] = {x, y, x * x, y * y, square * square};
    for (int m = 0; m < 5; ++m) moments[m] += values[m] / (side * side);
  }
  // The moments of the uniform disk are 0, 0, 1/4, 1/4, 1/3. The midpoint rule on squares 1/256
  // wide is off by curvature times 1/256^2 / 24, less than 1e-5.
  const double expected[5] = {0, 0, 0.25, 0.25, 1.0 / 3};
  for (int m = 0; m < 5; ++m) EXPECT_NEAR(moments[m], expected[m], 1e-4) << "moment " << m;
  // Local areas too: the map from [0, 1]^2 to the disk multiplies every small area by pi.
  const float h = 1e-2f;
  for (const V2f& at : square_grid(7)) {
    const auto p =
        disk_points({{at.x - h, at.y}, {at.x + h, at.y}, {at.x, at.y - h}, {at.x, at.y + h}});
    const double area =
        std::fabs((p[1].x - p[0].x) * (p[3].y - p[2].y) - (p[1].y - p[0].y) * (p[3].x - p[2].x)) /
        (4 * h * h);
    // The middle column and row lie on the creases of the map.
    if (std::fabs(at.x - at.y) > 2 * h && std::fabs(at.x + at.y - 1) > 2 * h) {
      EXPECT_NEAR(area, kPi, 0.02) << at;
    }
  }
}

TEST(Sampling, TheConcentricMapIsDefinedInTheCornersAndTheMiddle) {
  const float s = std::sqrt(0.5f);
  const auto p = disk_points({{0.5f, 0.5f}, {1, 1}, {0, 0}, {0, 1}, {1, 0.5f}, {0.5f, 0}});
  const V2f expected[6] = {{0, 0}, {s, s}, {-s, -s}, {-s, s}, {1, 0}, {0, -1}};
  for (int i = 0; i < 6; ++i) EXPECT_LT((p[i] - expected[i]).length(), 1e-6f) << p[i];
}

TEST(Sampling, AVogelSpiralsPointsAreAGoldenAngleApartInRingsOfOneArea) {
  constexpr uint kCount = 3000;
  const double golden = kPi * (3 - std::sqrt(5.0));
  const Buffer disk = device().allocate(kCount * sizeof(V2f));
  for (const auto& [jitter, turn] :
       {std::pair{0.0f, 0u}, {0.5f, 0x20000000u}, {0.999f, 0xdfffffffu}, {0.25f, 0x7fffffffu}}) {
    run("sampling", "vogel_points", kCount, {disk, jitter, turn, kCount});
    const auto points = download<V2f>(disk, kCount);
    for (uint k = 0; k < kCount; ++k) {
      const double radius = std::sqrt((k + double{jitter}) / kCount);
      const double angle = turn / 0x1p32 * 2 * kPi + golden * k;
      // The kernels' golden angle, in units of 2^-32 of a turn, is off by 0.43 units.
      const double off = 1e-6 + k * 1e-9;
      ASSERT_NEAR(points[k].x, radius * std::cos(angle), off) << k << " turned by " << turn;
      ASSERT_NEAR(points[k].y, radius * std::sin(angle), off) << k << " turned by " << turn;
    }
  }
}

TEST(Sampling, AnglesAreThoseOfTheMathLibrary) {
  std::vector<V2f> points = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}, {-1, -1e-30f}, {3e30f, 1}};
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 100'000; ++i) points.emplace_back(normal(random), normal(random));
  const auto count = static_cast<uint>(points.size());
  const Buffer turns = device().allocate(count * sizeof(float));
  run("sampling", "angles", count, {upload(points), turns, count});
  const auto found = download<float>(turns, count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Imath::V2d p(points[i]);
    ASSERT_NEAR(found[i], std::atan2(p.y, p.x) / (2 * kPi), 1e-7) << p.x << " " << p.y;
  }
}

TEST(Sampling, AShareIsTheStepThatANumberFallsInto) {
  for (const std::size_t steps : {1u, 2u, 3u, 5u, 64u, 1000u}) {
    std::vector<float> ascending;
    for (std::size_t i = 1; i <= steps; ++i) {
      // Every third step is empty: nothing may fall into it.
      const std::size_t end = i % 3 == 2 && i < steps ? i - 1 : i;
      ascending.push_back(static_cast<float>(end) / static_cast<float>(steps));
    }
    std::vector<float> numbers = {0, 0.99999994f};
    for (int i = 1; i < 777; ++i) numbers.push_back(static_cast<float>(i) / 777);
    numbers.insert(numbers.end(), ascending.begin(), ascending.end() - 1);  // the edges
    const auto count = static_cast<uint>(numbers.size());
    const Buffer places = device().allocate(count * sizeof(V2f));
    run("sampling", "shares", count,
        {upload(ascending), upload(numbers), places, static_cast<uint>(steps), count});
    const auto found = download<V2f>(places, count);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto above = std::upper_bound(ascending.begin(), ascending.end(), numbers[i]);
      const float before = above == ascending.begin() ? 0 : *(above - 1);
      ASSERT_EQ(found[i].x, static_cast<float>(above - ascending.begin())) << steps;
      ASSERT_NEAR(found[i].y, (numbers[i] - before) / (*above - before), 1e-4f) << steps;
    }
  }
}

TEST(Sampling, FramesAreOrthonormalAndRightHandedForEveryNormal) {
  std::vector<V3f> normals{{0, 0, 1},     {0, 0, -1},     {1, 0, 0},       {0, -1, 0},
                           {1, 0, -0.0f}, {1e-5f, 0, -1}, {0, 1e-20f, -1}, {0.6f, 0.8f, 0}};
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) normals.push_back(random_direction(random));
  for (int i = 0; i < 2000; ++i) {
    normals.push_back((V3f(0, 0, -1) + random_direction(random) * 1e-3f).normalized());
  }
  const Buffer tangents = device().allocate(normals.size() * sizeof(V3f));
  const Buffer bitangents = device().allocate(normals.size() * sizeof(V3f));
  for (const char* kernel : {"frames", "lane_frames"}) {
    run("sampling", kernel, normals.size(),
        {upload(normals), tangents, bitangents, static_cast<uint>(normals.size())});
    const auto t = download<V3f>(tangents, normals.size());
    const auto b = download<V3f>(bitangents, normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
      // Several roundings of numbers up to 1.
      EXPECT_NEAR(t[i].length(), 1, 2e-6f) << kernel << normals[i];
      EXPECT_NEAR(b[i].length(), 1, 2e-6f) << kernel << normals[i];
      EXPECT_LT((t[i].cross(b[i]) - normals[i]).length(), 2e-6f) << kernel << normals[i];
    }
  }
}

TEST(Sampling, ConeDirectionsStayInTheConeAndFillItUniformly) {
  const auto squares = square_grid(64);
  std::mt19937 random(2);
  for (const float one_minus_cos : {1.08e-5f, 0.01f, 0.5f, 1.0f, 2.0f}) {
    const V3f axis = random_direction(random);
    const std::vector<V3f> axes(squares.size(), axis);
    const Buffer directions = device().allocate(squares.size() * sizeof(V3f));
    run("sampling", "cone_directions", squares.size(),
        {upload(squares), upload(axes), directions, one_minus_cos,
         static_cast<uint>(squares.size())});
    double height = 0;
    V3d sum(0, 0, 0);
    for (const V3f& d : download<V3f>(directions, squares.size())) {
      EXPECT_NEAR(d.length(), 1, 1e-6f);
      // 1 - cos is computed from the chord, because a cosine near 1 loses its digits.
      const double from_axis = V3d(V3d(d) - V3d(axis)).length2() / 2;
      EXPECT_LE(from_axis, one_minus_cos * (1 + 1e-4) + 1e-7);
      height += from_axis / static_cast<double>(squares.size());
      sum += V3d(d) / static_cast<double>(squares.size());
    }
    // Directions uniform in solid angle are uniform in the cosine, so the mean height is half of
    // the cone's. In the thinnest cone a chord of 0.005 has an error of 1e-7.
    EXPECT_NEAR(height, 0.5 * one_minus_cos, 1e-3 * one_minus_cos);
    const V3d aside = sum - V3d(axis) * sum.dot(V3d(axis));
    EXPECT_LT(aside.length(), 1e-3 * std::sqrt(one_minus_cos)) << "the mean is off the axis";
  }
}

TEST(Sampling, FootprintsKeepClearOfTheLineOfSight) {
  const std::vector<V3f> directions = {
      {0, 0, 1}, {std::sqrt(0.75f), 0, 0.5f}, {0, 1, 0}, {0, 0, -1}, {0.6f, 0, -0.8f}};
  const auto solid_angles = [&](const V3f& origin, const Viewpoint& from) {
    const Buffer found = device().allocate(directions.size() * sizeof(float));
    run("sampling", "clear_of_view", directions.size(),
        {upload(directions), upload(std::vector<V3f>{origin}), from, found,
         static_cast<uint>(directions.size())});
    return download<float>(found, directions.size());
  };
  // 0.8 tan^2 of half the angles 0, 60, 90, 180 and 143 degrees; at most the ray's own, 1.
  const std::vector<float> wanted = {0, 0.8f / 3, 0.8f, 1, 1};
  const Viewpoint lens{{1, 2, 7}, 1, 1}, parallel{{0, 0, 1}, 0, 1}, unknown{{1, 2, 7}, 1, 0};
  for (const auto& found : {solid_angles({1, 2, 3}, lens), solid_angles({5, 5, 5}, parallel)}) {
    for (std::size_t i = 0; i < directions.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-6f);
  }
  EXPECT_EQ(solid_angles({1, 2, 7}, lens), std::vector<float>(directions.size(), 0.0f))
      << "at the lens itself there is no angle";
  EXPECT_EQ(solid_angles({1, 2, 3}, unknown), std::vector<float>(directions.size(), 1.0f));
}

}  // namespace
}  // namespace dapple
