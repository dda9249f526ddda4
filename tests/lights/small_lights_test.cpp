// Lights that are tiny, far away, huge or without area: their irradiance at radiance 1 spans thirty
// orders of magnitude, and sums of it in fixed point must neither lose nor exceed their bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

RenderOptions lights_only() {
  RenderOptions options = one_pixel();
  options.ao = false;
  return options;
}

Light above(LightKind kind, float height, float radius) {
  Light light;
  light.name = "above";
  light.kind = kind;
  light.position = V3f(0, height, 0);
  light.radius = radius;
  light.edge_u = V3f(radius, 0, 0);
  light.edge_v = V3f(0, 0, radius);
  return light;
}

/// The light's layer in a render of the point below it. `rays`: a multiple of 1,024, or 0.
double irradiance(Scene scene, int rays = 0) {
  RenderOptions options = lights_only();
  if (rays > 0) {
    options.spp = 1024;
    options.light_rays = rays / 1024;
  }
  return value(render(std::move(scene), options).film, "light.above.R");
}

TEST(SmallLights, FarSpheresDisksAndRectsHaveTheIrradianceOfTheirSolidAngles) {
  for (const auto& [height, radius] :
       {std::pair(3.0f, 1e-4f), {3.0f, 1e-7f}, {1000.0f, 0.1f}, {4000.0f, 0.1f}, {1e9f, 1e-3f}}) {
    SCOPED_TRACE(fmt::format("height {}, radius {}", height, radius));
    const double square = double{radius} * radius / (double{height} * height);
    for (const LightKind kind : {LightKind::sphere, LightKind::disk, LightKind::rect}) {
      Scene scene = point_on_ground();
      scene.lights = {above(kind, height, radius)};
      const double expected = kind == LightKind::rect ? square : kPi * square;
      EXPECT_NEAR(irradiance(scene) / expected, 1, 2e-3) << static_cast<int>(kind);
    }
  }
}

TEST(SmallLights, LampsNearTheGroundOfALargeSceneAreNotCutOff) {
  for (const float height : {0.2f, 1.0f, 10.0f}) {
    Scene scene = point_on_ground();
    scene.meshes[0] = square_mesh(2e5f, 0, 1, 0);
    scene.lights = {above(LightKind::sphere, height, 0.1f)};
    EXPECT_NEAR(irradiance(scene) / (kPi * 0.01 / (height * height)), 1, 2e-3) << height;
  }
}

// One pixel of 2^18 rays is one slice.
TEST(SmallLights, ManyRaysToALampNearTheGroundOfALargeSceneAddUp) {
  Scene scene = point_on_ground();
  scene.meshes[0] = square_mesh(2e3f, 0, 1, 0);
  scene.lights = {above(LightKind::sphere, 0.2f, 0.1f)};
  EXPECT_NEAR(irradiance(scene, 1 << 18) / (kPi * 0.25), 1, 2e-3);
}

TEST(SmallLights, NarrowSunsHaveTheIrradianceOfTheirSolidAngle) {
  for (const float radius : {1e-2f, 4e-5f, 1e-6f}) {
    Scene scene = point_on_ground();
    scene.lights = {above(LightKind::sun, 0, 1)};
    scene.lights[0].angular_radius = radius;
    EXPECT_NEAR(irradiance(scene) / (kPi * radius * radius), 1, 2e-3) << radius;
  }
}

TEST(SmallLights, SmallEmissiveMeshesHaveTheIrradianceOfTheirSolidAngle) {
  for (const float side : {1e-3f, 1e-6f}) {
    Scene scene = point_on_ground();
    scene.lights = {above(LightKind::mesh, 0, 1)};
    scene.lights[0].double_sided = true;
    place(scene, square_mesh(side, 3, 1, 0), {}, 0);
    EXPECT_NEAR(irradiance(scene) / (side * side / 9), 1, 2e-3) << side;
  }
}

TEST(SmallLights, AnEmissiveMeshWhoseTrianglesCollapseFarAwayGivesNoLight) {
  Scene scene = point_on_ground();
  scene.lights = {above(LightKind::mesh, 0, 1)};
  M44f far;
  far.translate(V3f(2e4f, 0, 2e4f));
  place(scene, square_mesh(1e-3f, 0.5f, 1, 0), far, 0);
  EXPECT_EQ(irradiance(scene), 0);
}

TEST(SmallLights, BelowRectsAndDisksOfAnySizeIrradianceIsThatOfTheHemisphere) {
  for (const LightKind kind : {LightKind::rect, LightKind::disk}) {
    for (const float side : {1e4f, 1e9f, 1e12f}) {
      Scene scene = point_on_ground();
      scene.lights = {above(kind, 2, side)};
      RenderOptions options = lights_only();
      options.spp = 64;
      const float found = value(render(scene, options).film, "light.above.R");
      EXPECT_NEAR(found, std::numbers::pi, 0.01) << side;
    }
  }
}

}  // namespace
}  // namespace dapple
