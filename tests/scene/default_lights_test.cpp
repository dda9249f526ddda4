// Lights that a scene may get: sun and sky stand where the camera says, and are as bright as they
// are said to be; the key light hangs up left in front and gives an irradiance of about one.
#include "scene/lights/default_lights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/images/dome_image.hpp"
#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

V3f row(const M44f& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

/// Irradiance of the upper half of the sky on a surface that faces up.
V3d from_above(const Light& sky) {
  const Environment& image = *sky.environment;
  V3d sum(0.0);
  for (std::uint32_t y = 0; y < image.height / 2; ++y) {
    const double angle = kPi * (y + 0.5) / image.height;
    for (std::uint32_t x = 0; x < image.width; ++x)
      sum += V3d(texel(image, x, y)) * (texel_solid_angle(image, y) * std::cos(angle));
  }
  return sum * V3d(sky.radiance);
}

TEST(Daylight, TheSunStandsUpLeftInFrontAtAnyTiltOfTheCamera) {
  for (const V3f& from : {V3f(0, 1, 6), V3f(6, 1, 0), V3f(-3, 4, -3), V3f(0, -5, 5)}) {
    const Camera camera = look_at(from, {0, 0.5f, 0}, {0, 1, 0}, 0.7f);
    const std::vector<Light> lights = daylight(camera);
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[0].name, "sun");
    EXPECT_EQ(lights[0].kind, LightKind::sun);
    const V3f towards = -lights[0].direction, back = row(camera.to_world, 2);
    EXPECT_NEAR(towards.length(), 1, 1e-6);
    const double elevation = std::asin(towards.y) * 180 / kPi;
    EXPECT_GT(elevation, 30);
    EXPECT_LT(elevation, 60);
    EXPECT_LT(towards.dot(row(camera.to_world, 0)), 0);
    EXPECT_GT(towards.dot(V3f(back.x, 0, back.z)), 0);
  }
}

TEST(Daylight, TheSunDoesNotJumpWhereTheCameraLooksStraightDownOrUp) {
  for (const float height : {10.0f, -10.0f}) {
    const auto sun = [&](float aside) {
      const V3f up(0, 0, height > 0 ? -1.0f : 1.0f);  // as if it had been level before
      return daylight(look_at({0, height, aside}, {0, 0, 0}, up, 0.7f))[0].direction;
    };
    EXPECT_GT(sun(0).dot(sun(0.02f)), 0.9999f) << height;
  }
}

TEST(Daylight, TheNoteOffersAGroundOnlyWhereThereIsNone) {
  const std::string note = default_light_note(true);
  EXPECT_NE(note.find("--lights F"), std::string::npos) << note;
  EXPECT_EQ(note.find("--ground"), std::string::npos) << note;
  EXPECT_EQ(default_light_note(false), note + ", --ground a floor for their shadows");
}

TEST(Daylight, TheSunIsWarmTheSkyBlueAndClearlyDimmer) {
  const std::vector<Light> lights = daylight(look_at({0, 1, 6}, {0, 0, 0}, {0, 1, 0}, 0.7f));
  const double sine = std::sin(lights[0].angular_radius);
  const V3d sun = V3d(lights[0].radiance) * (kPi * sine * sine), sky = from_above(lights[1]);
  EXPECT_EQ(lights[1].kind, LightKind::dome);
  EXPECT_GT(sun.x, sun.z);
  EXPECT_GT(sky.z, 1.2 * sky.x);
  EXPECT_GT(sun.y, 3 * sky.y);
  EXPECT_LT(sun.y, 8 * sky.y);
}

TEST(Daylight, LightsAnOpenGroundAsItsImageSays) {
  const Scene scene = point_on_ground();
  const Film film = render(scene, one_pixel()).film;  // a scene without lights
  const std::vector<Light> lights = daylight(scene.cameras[0]);
  const V3d sky = from_above(lights[1]);
  // Half of the rays follow the image, where light and cosine differ more than a uniform sky's.
  EXPECT_NEAR(value(film, "light.sky.R"), sky.x, 0.01 * sky.x);
  EXPECT_NEAR(value(film, "light.sky.B"), sky.z, 0.01 * sky.z);
  const double sine = std::sin(lights[0].angular_radius);
  const double sun = lights[0].radiance.y * kPi * sine * sine * -lights[0].direction.y;
  EXPECT_NEAR(value(film, "light.sun.G"), sun, sun * kSampling);
}

TEST(KeyLight, HangsUpLeftInFrontAndFacesTheCentre) {
  const Scene scene = make_procedural("scene:cube");
  for (const V3f& from : {V3f(0, 1, 6), V3f(6, 1, 0), V3f(-3, 4, -3), V3f(0, -5, 5)}) {
    const V3f centre(0, 0.5f, 0);
    const Camera camera = look_at(from, centre, {0, 1, 0}, 0.7f);
    const Light key = key_light(scene, camera);
    EXPECT_EQ(key.name, "key");
    EXPECT_EQ(key.kind, LightKind::rect);
    const V3f from_centre = key.position - centre;
    const M44f& axes = camera.to_world;
    EXPECT_GT(from_centre.y, 0);
    EXPECT_LT(from_centre.dot(V3f(axes[0][0], axes[0][1], axes[0][2])), 0);
    EXPECT_GT(from_centre.dot(V3f(axes[2][0], 0, axes[2][2])), 0);  // at any tilt of the camera
    EXPECT_TRUE((-from_centre).normalized().equalWithAbsError(key.direction, 1e-5f));
    const float radius = std::sqrt(3.0f) / 2;
    EXPECT_NEAR(from_centre.length(), 3 * radius, 1e-4);
    EXPECT_NEAR(key.edge_u.length(), radius, 1e-5);
    EXPECT_NEAR(key.edge_v.length(), radius, 1e-5);
    EXPECT_NEAR(key.edge_u.dot(key.direction), 0, 1e-5);
    EXPECT_NEAR(key.edge_u.y, 0, 1e-6);
  }
}

TEST(KeyLight, GivesASurfaceAtTheCentreThatFacesItAnIrradianceOfAboutOne) {
  const Scene scene = make_procedural("scene:cube");
  const Light key = key_light(scene, frame_scene(scene, 1.5f));
  const V3f centre(0, 0.5f, 0);
  constexpr int kCells = 64;
  double irradiance = 0;
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / kCells - 0.5f;
      const float v = (static_cast<float>(j) + 0.5f) / kCells - 0.5f;
      const V3f to_light = key.position + key.edge_u * u + key.edge_v * v - centre;
      const float cosine = -key.direction.dot(to_light.normalized());
      irradiance += key.radiance.x * cosine * cosine / to_light.length2();
    }
  }
  irradiance *= key.edge_u.length() * key.edge_v.length() / (kCells * kCells);
  // To first order the irradiance is 1. The extent of the square light reduces it by
  // 2 * (1/6)^2 * 2/3.
  EXPECT_NEAR(irradiance, 1 - 0.037, 0.005);
}

}  // namespace
}  // namespace dapple
