// Samples of rects and disks: by solid angle where they are near, whatever the place of the
// receiver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/light_samples.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

/// A level rect above the origin, which emits down: corner x, y and edges, metres.
struct LevelRect {
  float x, z, width, depth, height;
};

Scene scene_of(const LevelRect& rect) {
  return rect_scene({rect.x + 0.5f * rect.width, rect.height, rect.z + 0.5f * rect.depth},
                    {rect.width, 0, 0}, {0, 0, rect.depth}, {0, -1, 0});
}

/// Solid angle of the part of `rect` up to `x` and `z`, from its corner.
double solid_angle(const LevelRect& rect, double x, double z) {
  const double h = rect.height;
  const auto corner = [h](double a, double b) {
    return std::atan2(a * b, h * std::sqrt(a * a + b * b + h * h));
  };
  return corner(x, z) - corner(rect.x, z) - corner(x, rect.z) + corner(rect.x, rect.z);
}

double solid_angle(const LevelRect& rect) {
  return solid_angle(rect, double(rect.x) + rect.width, double(rect.z) + rect.depth);
}

const LevelRect kRects[] = {
    {-0.5f, -0.5f, 1, 1, 1},           // a window
    {-500, -400, 1000, 900, 2},        // a ceiling
    {-0.01f, -20, 0.02f, 40, 0.5f},    // a tube, in either direction
    {-20, -0.01f, 40, 0.02f, 0.5f},    //
    {5, -0.5f, 1, 1, 0.1f},            // seen from its side
    {0, 5, 1, 95, 0.1f},               // seen from its end
    {1e-3f, 2, 0.01f, 1, 0.05f},       // almost from its own line
    {-3, 0.01f, 7, 10, 1},             // from beside an edge
    {-5e5f, -5e5f, 1e6f, 1e6f, 0.5f},  // the sky
};

TEST(RectSampling, IsUniformBySolidAngleAtAnyDistance) {
  for (const LevelRect& rect : kRects) {
    SCOPED_TRACE(::testing::Message() << rect.x << ' ' << rect.z << ' ' << rect.width);
    const Samples samples = light_samples(scene_of(rect));
    const double expected = solid_angle(rect);
    double sum = 0, squares = 0, half = 0;
    const double middle_x = rect.x + 0.5 * rect.width, middle_z = rect.z + 0.5 * rect.depth;
    for (uint i = 0; i < kLightSamples; ++i) {
      const double weight = samples.solid_angles[i];
      sum += weight;
      squares += weight * weight;
      const V3f at = samples.directions[i] * samples.distances[i];
      if (at.x < middle_x && at.z < middle_z) half += weight;
    }
    const double mean = sum / kLightSamples;
    EXPECT_NEAR(mean, expected, 1e-3 * expected);
    EXPECT_LT(std::sqrt(std::max(0.0, squares / kLightSamples - mean * mean)), 0.1 * expected);
    EXPECT_NEAR(half / kLightSamples, solid_angle(rect, middle_x, middle_z), 4e-3 * expected);
  }
}

TEST(RectSampling, PointsLieOnTheRect) {
  for (const LevelRect& rect : kRects) {
    SCOPED_TRACE(::testing::Message() << rect.x << ' ' << rect.z << ' ' << rect.width);
    const Samples samples = light_samples(scene_of(rect));
    const float rounding =
        1e-5f * (std::fabs(rect.x) + rect.width + std::fabs(rect.z) + rect.depth);
    for (uint i = 0; i < kLightSamples; ++i) {
      const V3f at = samples.directions[i] * samples.distances[i];
      ASSERT_NEAR(at.y, rect.height, rounding);
      ASSERT_GE(at.x, rect.x - rounding);
      ASSERT_LE(at.x, rect.x + rect.width + rounding);
      ASSERT_GE(at.z, rect.z - rounding);
      ASSERT_LE(at.z, rect.z + rect.depth + rounding);
      ASSERT_NEAR(samples.directions[i].length(), 1, 1e-5f);
    }
  }
}

TEST(RectSampling, SmallRectsFarAwayLoseNoDigits) {
  for (const float distance : {1e2f, 1e4f, 1e6f}) {
    const LevelRect rect{0.3f * distance, -0.2f * distance, 1e-3f, 2e-3f, distance};
    const Samples samples = light_samples(scene_of(rect));
    const double square = distance * double(distance), cosine = 1 / std::sqrt(1.13);
    const double expected = 2e-6 * cosine / (1.13 * square);
    for (uint i = 0; i < kLightSamples; ++i)
      ASSERT_NEAR(samples.solid_angles[i], expected, 2e-4 * expected) << distance;
  }
}

TEST(RectSampling, ATiltedPlainOverheadIsAsFarAsItsPlane) {
  for (const float height : {0.1f, 10.0f}) {
    const V3f facing(-0.6f, -0.8f, 0), edge(0.8e5f, -0.6e5f, 0);
    const Samples samples = light_samples(rect_scene(facing * -height, edge, {0, 0, 1e5f}, facing));
    double sum = 0;
    for (const float weight : samples.solid_angles) sum += weight;
    EXPECT_NEAR(sum / kLightSamples, 2 * std::numbers::pi, 5e-3) << height;
  }
}

TEST(RectSampling, NothingReachesItsPlaneOrItsBack) {
  for (const float height : {0.0f, -1e-6f, -2.0f}) {
    const Samples samples = light_samples(scene_of({-1, -1, 2, 2, height}));
    for (const float weight : samples.solid_angles) ASSERT_EQ(weight, 0) << height;
  }
}

// Edges that are not perpendicular, and light that leaves a rect at a slant, are sampled by area.
TEST(RectSampling, ParallelogramsKeepTheirFormFactor) {
  const V3f at(0.3f, 4, -0.2f), u(2, 0, 0), v(1.2f, 0, 1);
  const auto corner = [&](float a, float b) { return V3d(at + u * a + v * b); };
  const double expected = polygon_irradiance(
      {corner(-0.5f, -0.5f), corner(0.5f, -0.5f), corner(0.5f, 0.5f), corner(-0.5f, 0.5f)});
  const double straight = light_samples(rect_scene(at, u, v, {0, -1, 0})).irradiance();
  EXPECT_NEAR(straight, expected, kIntegrationError * expected);
  const double slanted = light_samples(rect_scene(at, u, v, {0, -1, 0.5f})).irradiance();
  EXPECT_NEAR(slanted, expected / std::sqrt(1.25), 0.1 * expected);
}

// Up to one radius away they are sampled by solid angle, too.
TEST(DiskSampling, NearDisksHaveTheSolidAngleOfTheirConeWithLittleNoise) {
  const struct {
    float height, noise;  // standard deviation of weights over their mean, at most
  } heights[] = {{1e-3f, 0.01f}, {0.1f, 0.15f}, {0.9f, 0.4f}, {1.5f, 0.3f}};
  for (const auto& [height, noise] : heights) {
    Scene scene;
    Light light;
    light.kind = LightKind::disk;
    light.radius = 500;
    light.position = V3f(0, height * light.radius, 0);
    scene.lights = {light};
    const Samples samples = light_samples(scene);
    double sum = 0, squares = 0;
    for (const float weight : samples.solid_angles) {
      sum += weight;
      squares += double(weight) * weight;
    }
    const double mean = sum / kLightSamples, cosine = height / std::hypot(height, 1.0);
    const double expected = 2 * std::numbers::pi * (1 - cosine);
    EXPECT_NEAR(mean, expected, 3e-3 * expected) << height;
    EXPECT_LT(std::sqrt(std::max(0.0, squares / kLightSamples - mean * mean)), noise * mean)
        << height;
    const double irradiance = std::numbers::pi * (1 - cosine * cosine);
    EXPECT_NEAR(samples.irradiance(), irradiance, 5e-3 * irradiance) << height;
  }
}

}  // namespace
}  // namespace dapple
