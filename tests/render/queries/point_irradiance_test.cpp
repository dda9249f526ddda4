// irradiance() at points against closed forms: suns, rects and domes, with and without occluders,
// and arguments that are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Mesh square(float side, float height) {
  Mesh mesh;
  append_grid(mesh, {-side / 2, height, -side / 2}, {0, 0, side}, {side, 0, 0}, 4, 0);
  return mesh;
}

/// A leaf of the given opacity over the origin, and a light.
Scene lit(Light light, float opacity, float side = 4, float height = 0.5f) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = opacity;
  scene.meshes = {square(side, height)};
  scene.instances.resize(1);
  scene.lights = {std::move(light)};
  finalize_domes(scene);
  return scene;
}

Light sun() {
  Light light;
  light.kind = LightKind::sun;
  light.direction = V3f(0, -1, 0);
  light.angular_radius = 0.02f;
  light.radiance = V3f(1000, 900, 500);
  return light;
}

Light rect() {
  Light light;
  light.kind = LightKind::rect;
  light.position = V3f(0, 2, 0);
  light.direction = V3f(0, -1, 0);
  light.edge_u = V3f(2, 0, 0);
  light.edge_v = V3f(0, 0, 1);
  return light;
}

/// At the point below its centre, at distance h: four times the form factor of a quarter.
double rect_irradiance(double a, double b, double h) {
  const auto part = [](double x, double y, double d) {
    const double root = std::sqrt(d * d + x * x);
    return x / root * std::atan(y / root);
  };
  return 4 * 0.5 * (part(a / 2, b / 2, h) + part(b / 2, a / 2, h));
}

struct At {
  V3f seen, all;
};

At at_origin(const Scene& scene, Estimator estimator, int rays = 1024) {
  const SceneOnDevice uploaded(scene);
  IrradianceOptions options;
  options.rays = rays;
  options.estimator = estimator;
  const auto found = irradiance(device(), uploaded.uploaded, uploaded.scene.lights,
                                std::vector{V3f(0, 0, 0)}, std::vector{V3f(0, 1, 0)}, options);
  return {found.at(0).irradiance.at(0), found[0].unoccluded.at(0)};
}

TEST(PointIrradiance, ASunAboveIsItsRadianceTimesItsProjectedSolidAngle) {
  for (const float opacity : {0.01f, 0.5f, 1.0f}) {
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      const At e = at_origin(lit(sun(), opacity), estimator);
      const double open = 1000 * kPi * std::pow(std::sin(0.02), 2);
      EXPECT_NEAR(double{e.all.x}, open, 1e-3 * open);
      EXPECT_NEAR(double{e.seen.x}, (1 - opacity) * open, 0.01 * open) << opacity;
      EXPECT_NEAR(double{e.seen.y}, 0.9 * double{e.seen.x}, 1e-4 * open);
    }
  }
}

TEST(PointIrradiance, ARectangleAboveHasItsFormFactor) {
  const At e = at_origin(lit(rect(), 1, 0.1f, 5), Estimator::exact);  // the leaf is above the light
  EXPECT_NEAR(double{e.seen.x}, rect_irradiance(2, 1, 2), 0.005);
  EXPECT_EQ(e.seen, e.all);
  // A leaf of half the opacity between light and point.
  const At half = at_origin(lit(rect(), 0.5f), Estimator::prefiltered);
  EXPECT_NEAR(double{half.seen.x}, 0.5 * rect_irradiance(2, 1, 2), 0.01);
}

TEST(PointIrradiance, AUniformDomeIsPiTimesItsRadianceAndAWallTakesHalf) {
  Light dome;
  dome.kind = LightKind::dome;
  dome.radiance = V3f(1, 2, 3);
  Scene scene = lit(dome, 1, 0.1f, -5);
  EXPECT_NEAR(double{at_origin(scene, Estimator::exact).seen.y}, 2 * kPi, 0.01);
  // A wall that reaches from the point to infinity, nearly.
  Mesh wall;
  append_grid(wall, {1e-3f, 0, -1e4f}, {0, 1e4f, 0}, {0, 0, 2e4f}, 4, 0);
  scene.meshes[0] = wall;
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered})
    EXPECT_NEAR(double{at_origin(scene, estimator).seen.z}, 1.5 * kPi, 0.15) << "3 pi / 2";
}

TEST(PointIrradiance, AnImageOfTwoHalvesLightsWithBothColours) {
  auto image = std::make_shared<Environment>();
  image->width = 64;
  image->height = 32;
  for (std::uint32_t y = 0; y < 32; ++y)
    for (std::uint32_t x = 0; x < 64; ++x)
      image->radiance.push_back(y < 16 ? V3f(4, 2, 1) : V3f(0, 0, 9));
  Light dome;
  dome.kind = LightKind::dome;
  dome.environment = image;
  const At e = at_origin(lit(dome, 1, 0.1f, -5), Estimator::exact, 4096);
  EXPECT_NEAR(double{e.seen.x}, 4 * kPi, 0.1) << "the upper half is over the point";
  EXPECT_NEAR(double{e.seen.z}, kPi, 0.1);
}

TEST(PointIrradiance, PointsBelowTheHorizonHaveNoneAndOrderDoesNotMatter) {
  const SceneOnDevice scene(lit(sun(), 0.5f));
  const std::vector<V3f> points{{0, 0, 0}, {0.3f, 0, 0.2f}, {-9, 0, 0}};
  const std::vector<V3f> normals{{0, -1, 0}, {0, 1, 0}, {0, 1, 0}};
  const auto found = irradiance(device(), scene.uploaded, scene.scene.lights, points, normals);
  EXPECT_EQ(found.at(0).irradiance.at(0), V3f(0, 0, 0));
  EXPECT_GT(found[0].irradiance[1].x, 0);
  EXPECT_EQ(found[0].irradiance[2], found[0].unoccluded[2]) << "beside the leaf";
  const auto again = irradiance(device(), scene.uploaded, scene.scene.lights, points, normals);
  EXPECT_EQ(again[0].irradiance, found[0].irradiance);
}

TEST(PointIrradiance, EmptyInputIsEmptyAndWrongSizesAreErrors) {
  const SceneOnDevice scene(lit(sun(), 0.5f));
  const std::vector<V3f> one{V3f(0, 0, 0)}, none;
  EXPECT_TRUE(irradiance(device(), scene.uploaded, scene.scene.lights, none, none)
                  .at(0)
                  .irradiance.empty());
  EXPECT_THROW(irradiance(device(), scene.uploaded, scene.scene.lights, one, none), Error);
  EXPECT_THROW(irradiance(device(), scene.uploaded, {}, one, one), Error);
}

}  // namespace
}  // namespace dapple
