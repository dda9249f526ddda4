// Disks and spots against closed forms: a disk's form factor above and beside a point, at any tilt;
// a spot's cone by the formula of KHR_lights_punctual, at angles from inside to outside.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "film/layers.hpp"
#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

Light disk(const std::string& name, V3f position, V3f direction, float radius) {
  Light light;
  light.name = name;
  light.kind = LightKind::disk;
  light.position = position;
  light.direction = direction.normalized();
  light.radius = radius;
  return light;
}

RenderOptions lights_only() {
  RenderOptions options = one_pixel();
  options.ao = false;
  return options;
}

/// Irradiance of a disk of radiance 1, parallel to the ground, `beside` metres from straight above:
/// Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-13.
double parallel_disk(double radius, double height, double beside) {
  const double h = height / radius, r = beside / radius;
  const double z = 1 + h * h + r * r;
  return kPi * 0.5 * (1 - (z - 2) / std::sqrt(z * z - 4 * r * r));
}

// Sampled by area, as disks are that are far away, a hundredth of the points sees nearly all the
// light: the error of 4096 rays was 20 %.
TEST(DiskLight, HasLittleNoiseCloseToItsRim) {
  Scene scene = point_on_ground();
  std::vector<double> expected;
  for (const float height : {0.01f, 0.1f, 0.5f})
    for (const float beyond : {0.01f, 0.1f}) {
      scene.lights.push_back(disk("rim", {1 + beyond, height, 0}, {0, -1, 0}, 1));
      expected.push_back(parallel_disk(1, double{height}, 1.0 + double{beyond}));
    }
  for (const Packets packets : {Packets::automatic, Packets::scalar}) {
    RenderOptions options = lights_only();
    options.packets = packets;
    const Film film = render(scene, options).film;
    const std::vector<std::string> layers = light_names(scene.lights);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(value(film, "light." + layers[i] + ".R"), expected[i], 0.01 * expected[i]) << i;
  }
}

TEST(DiskLight, IrradianceOfADiskAboveAPointIsItsClosedForm) {
  Scene scene = point_on_ground();
  std::vector<double> expected;
  for (const auto& [radius, height] : {std::pair(0.5, 2.0), {3.0, 1.0}, {0.01, 5.0}}) {
    scene.lights.push_back(
        disk("above", {0, static_cast<float>(height), 0}, {0, -1, 0}, static_cast<float>(radius)));
    expected.push_back(kPi * radius * radius / (radius * radius + height * height));
    EXPECT_NEAR(parallel_disk(radius, height, 0), expected.back(), 1e-9);
  }
  for (const double beside : {0.5, 2.0}) {
    scene.lights.push_back(disk("beside", {0, 1.5f, static_cast<float>(beside)}, {0, -1, 0}, 1));
    expected.push_back(parallel_disk(1, 1.5, beside));
  }
  scene.lights.push_back(disk("away", {0, 2, 0}, {0, 1, 0}, 1));  // emits from its front only
  expected.push_back(0);
  for (Light& light : scene.lights) light.radiance = V3f(1, 2, 0.25f);
  const Film film = render(scene, lights_only()).film;
  const char* layers[] = {"above", "above_2", "above_3", "beside", "beside_2", "away"};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::string layer = std::string("light.") + layers[i];
    const double error = kSampling * expected[i] + 1e-12;
    EXPECT_NEAR(value(film, layer + ".R"), expected[i], error) << layer;
    EXPECT_NEAR(value(film, layer + ".G"), 2 * expected[i], 2 * error) << layer;
    EXPECT_NEAR(value(film, layer + ".B"), expected[i] / 4, error / 4) << layer;
  }
}

/// Irradiance of the disk by quadrature over rings and angles.
double quadrature(const Light& light, V3d axis_u, V3d axis_v) {
  constexpr int kRings = 200, kAngles = 400;
  double sum = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double r = light.radius * std::sqrt((ring + 0.5) / kRings);
    for (int a = 0; a < kAngles; ++a) {
      const double angle = 2 * kPi * (a + 0.5) / kAngles;
      const V3d to =
          V3d(light.position) + axis_u * (r * std::cos(angle)) + axis_v * (r * std::sin(angle));
      const V3d way = to.normalized();
      sum += std::max(0.0, way.y) * std::max(0.0, -way.dot(V3d(light.direction))) / to.length2();
    }
  }
  return sum * kPi * light.radius * light.radius / (kRings * kAngles);
}

TEST(DiskLight, ATiltedDiskIsRoundAndShinesAlongItsNormal) {
  Scene scene = point_on_ground();
  const Light light = disk("tilted", {1, 2, -1}, {-1, -1, 0.2f}, 0.8f);
  scene.lights = {light};
  const V3d normal(light.direction), u = normal.cross(V3d(0, 1, 0)).normalized();
  const double expected = quadrature(light, u, normal.cross(u));
  ASSERT_GT(expected, 0.1);
  EXPECT_NEAR(value(render(scene, lights_only()).film, "light.tilted.R"), expected,
              kSampling * expected);
}

TEST(DiskLight, AnOccluderBetweenTakesItsOpacity) {
  Scene scene = point_on_ground();
  scene.lights = {disk("disk", {0, 2, 0}, {0, -1, 0}, 0.5f)};
  const float free = value(render(scene, lights_only()).film, "light.disk.R");
  scene.materials.push_back(material_of(0.25f));
  place(scene, square_mesh(6, 1.25f, 1, 1));
  EXPECT_NEAR(value(render(scene, lights_only()).film, "light.disk.R"), 0.75 * free, 1e-3 * free);
}

/// What a spot straight above gives when it is turned by `degrees`, over what it gives without a
/// cone.
double through_cone(double degrees, double inner, double outer) {
  Scene scene = point_on_ground();
  const auto cosine = [](double angle) { return static_cast<float>(std::cos(angle * kPi / 180)); };
  Light light;
  light.name = "spot";
  light.kind = LightKind::sphere;
  light.radius = 0.1f;
  light.position = {0, 2, 0};
  light.direction = V3f(std::sin(static_cast<float>(degrees * kPi / 180)), -cosine(degrees), 0);
  scene.lights = {light};
  light.name = "cone";
  light.cos_inner = cosine(inner);
  light.cos_outer = cosine(outer);
  scene.lights.push_back(light);
  const Film film = render(scene, lights_only()).film;
  return value(film, "light.cone.R") / value(film, "light.spot.R");
}

TEST(SpotLight, ItsConeFallsSmoothlyAsKhrLightsPunctualSays) {
  const double inner = std::cos(20 * kPi / 180), outer = std::cos(50 * kPi / 180);
  double last = 1;
  for (int degrees = 0; degrees <= 60; degrees += 5) {
    const double cosine = std::cos(degrees * kPi / 180);
    const double part = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    const double found = through_cone(degrees, 20, 50);
    EXPECT_NEAR(found, part * part, 1e-3) << degrees;  // the same rays: only roundings differ
    EXPECT_LE(found, last + 1e-6) << degrees;
    last = found;
  }
  EXPECT_EQ(last, 0);
  EXPECT_NEAR(through_cone(29, 30, 30), 1, 1e-3) << "a cone without a soft edge";
  EXPECT_EQ(through_cone(31, 30, 30), 0);
}

TEST(SpotLight, NarrowConesHaveTheirFullLightInside) {
  for (const double outer : {5.0, 1.0, 0.2}) {
    EXPECT_NEAR(through_cone(0, 0, outer), 1, 1e-3) << outer;
    EXPECT_NEAR(through_cone(0.45 * outer, 0.5 * outer, outer), 1, 1e-3) << outer;
    EXPECT_NEAR(through_cone(0.5 * outer, 0, outer), 0.75 * 0.75, 0.02) << outer;
    EXPECT_EQ(through_cone(1.05 * outer, 0, outer), 0) << outer;
  }
}

}  // namespace
}  // namespace dapple
