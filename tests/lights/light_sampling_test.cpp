// Samples of lights, as the kernels take them, must integrate to irradiances known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/light_samples.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

constexpr double kPi = std::numbers::pi;

TEST(LightSampling, ARectIntegratesToItsFormFactor) {
  for (const V3f& at : {V3f(0, 2, 0), V3f(1.5f, 1, -0.5f), V3f(0.3f, 20, 4)}) {
    const V3f u(2, 0, 0), v(0, 0.5f, 0.8f);
    const V3f down = u.cross(v).y < 0 ? u.cross(v) : v.cross(u);
    const V3f c[4] = {at - u * 0.5f - v * 0.5f, at + u * 0.5f - v * 0.5f, at + u * 0.5f + v * 0.5f,
                      at - u * 0.5f + v * 0.5f};
    const double expected = polygon_irradiance({V3d(c[0]), V3d(c[1]), V3d(c[2]), V3d(c[3])});
    // The receiver at the origin is lit only if it is in front of the rect.
    const bool lit = down.dot(-at) > 0;
    const double front = light_samples(rect_scene(at, u, v, down)).irradiance();
    const double back = light_samples(rect_scene(at, u, v, -down)).irradiance();
    EXPECT_NEAR(lit ? front : back, expected, kIntegrationError * expected) << at;
    EXPECT_EQ(lit ? back : front, 0) << at;
  }
}

TEST(LightSampling, RectSamplesEndOnTheRect) {
  const V3f at(1, 3, -1);
  const Samples samples = light_samples(rect_scene(at, {2, 0, 0}, {0, 0, 1}, {0, -1, 0}));
  for (uint i = 0; i < kLightSamples; ++i) {
    const V3f p = samples.directions[i] * samples.distances[i] - at;
    ASSERT_TRUE(std::fabs(p.x) <= 1.0001f && std::fabs(p.y) <= 1e-5f && std::fabs(p.z) <= 0.5001f);
  }
}

TEST(LightSampling, ASphereIntegratesToPiTimesTheSquaredSineOfItsRadius) {
  Scene scene;
  Light light;
  light.kind = LightKind::sphere;
  for (const auto& [position, radius] :
       {std::pair{V3f(0, 2, 0), 1.0f}, {V3f(3, 4, 0), 0.01f}, {V3f(1, 2, 2), 1.9f}}) {
    light.position = position;
    light.radius = radius;
    scene.lights = {light};
    const Samples samples = light_samples(scene);
    // A sphere above the horizon: pi sin^2(angular radius) times the cosine to its centre.
    const double distance = position.length(), sine = radius / distance;
    const double expected = kPi * sine * sine * position.y / distance;
    EXPECT_NEAR(samples.irradiance(), expected, kIntegrationError * expected);
    for (uint i = 0; i < kLightSamples; ++i) {
      // The distance along a tangent ray is only known to sqrt(roundings of distance^2).
      const V3f from_centre = samples.directions[i] * samples.distances[i] - position;
      ASSERT_NEAR(from_centre.length(), radius, 1e-3 * distance);
      ASSERT_LE(from_centre.dot(samples.directions[i]), 1e-3 * distance) << "the far side";
    }
  }
}

TEST(LightSampling, FromInsideASphereEveryDirectionIsLit) {
  Scene scene;
  Light light;
  light.kind = LightKind::sphere;
  light.position = V3f(0.3f, -0.2f, 0.1f);
  light.radius = 1;
  scene.lights = {light};
  const Samples samples = light_samples(scene);
  EXPECT_NEAR(samples.irradiance(), kPi, kIntegrationError * kPi);
  for (uint i = 0; i < kLightSamples; ++i) {
    ASSERT_NEAR((samples.directions[i] * samples.distances[i] - light.position).length(), 1, 1e-5f);
  }
}

TEST(LightSampling, ASunIntegratesToPiTimesTheSquaredSineOfItsRadius) {
  Scene scene;
  Light light;
  light.kind = LightKind::sun;
  light.direction = V3f(0.6f, -0.8f, 0);
  for (const float radius : {0.00465f, 0.2f, 0.6f}) {
    light.angular_radius = radius;
    scene.lights = {light};
    const Samples samples = light_samples(scene);
    const double expected = kPi * std::pow(std::sin(radius), 2) * 0.8;
    EXPECT_NEAR(samples.irradiance(), expected, kIntegrationError * expected);
    EXPECT_TRUE(std::isinf(samples.distances[0]));
  }
}

/// A light of two triangles of different size, transformed by `to_world`; its front faces down.
Scene mesh_light_scene(const M44f& to_world, bool double_sided) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.positions = {{-1, 2, -1},     {2, 2, -1},      {-1, 2, 1},
                    {0.5f, 1.5f, 0}, {0.8f, 1.5f, 0}, {0.5f, 1.6f, 0.4f}};
  mesh.indices = {0, 1, 2, 3, 4, 5};
  mesh.materials = {0, 0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, to_world, 0});
  Light light;
  light.kind = LightKind::mesh;
  light.double_sided = double_sided;
  scene.lights.push_back(light);
  return scene;
}

TEST(LightSampling, AMeshIntegratesToTheSumOfItsTriangles) {
  const M44f mirrored = M44f().setScale(V3f(-1, 1, 1)),
             sheared = M44f(1, 0, 0.3f, 0, 0, 1.5f, 0, 0, 0.2f, 0, 2, 0, 0.1f, 0.2f, 0, 1);
  for (const M44f& to_world : {M44f(), mirrored, sheared}) {
    const Scene scene = mesh_light_scene(to_world, false);
    const Mesh& mesh = scene.meshes[0];
    double expected = 0;
    for (std::size_t t = 0; t < 2; ++t) {
      std::vector<V3d> corners;
      for (std::size_t c = 0; c < 3; ++c)
        corners.emplace_back(mesh.positions[3 * t + c] * to_world);
      expected += polygon_irradiance(corners);
    }
    // Each triangle gets a part of one stretched sequence, which is less even than a whole one.
    EXPECT_NEAR(light_samples(scene).irradiance(), expected, 10 * kIntegrationError * expected);
    EXPECT_NEAR(light_samples(mesh_light_scene(to_world, true)).irradiance(), expected,
                10 * kIntegrationError * expected);
  }
}

/// Triangles of a hand's breadth among which the receiver lies, all above its horizon.
Scene leaves_that_glow(std::uint32_t count) {
  Scene scene = mesh_light_scene(M44f(), true);
  Mesh& mesh = scene.meshes[0];
  mesh = {};
  std::uint32_t random = 1;
  const auto number = [&] {
    random = random * 1664525u + 1013904223u;
    return static_cast<float>(random >> 8) / 16777216.0f;
  };
  for (std::uint32_t t = 0; t < count; ++t) {
    const V3f at(number() * 8 - 4, number() * 4 + 0.06f, number() * 8 - 4);
    for (std::uint32_t c = 0; c < 3; ++c) {
      mesh.positions.push_back(at + V3f(number() - 0.5f, number() - 0.5f, number() - 0.5f) * 0.1f);
      mesh.indices.push_back(3 * t + c);
    }
    mesh.materials.push_back(0);
  }
  return scene;
}

TEST(LightSampling, OfManyTrianglesThoseAreChosenThatBringMuch) {
  const Scene scene = leaves_that_glow(5000);
  const Mesh& mesh = scene.meshes[0];
  double expected = 0, area = 0, squares_by_area = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const V3d a(mesh.positions[3 * t]), b(mesh.positions[3 * t + 1]), c(mesh.positions[3 * t + 2]);
    const double one = polygon_irradiance({a, b, c}), of_triangle = (b - a).cross(c - a).length();
    expected += one;
    area += of_triangle;
    squares_by_area += one * one / of_triangle;
  }
  squares_by_area *= area;  // the mean square of samples that choose triangles by area, at least
  const Samples samples = light_samples(scene);
  EXPECT_NEAR(samples.irradiance(), expected, 0.01 * expected);
  double squares = 0, largest = 0;
  for (std::size_t i = 0; i < samples.directions.size(); ++i) {
    const double one = samples.solid_angles[i] * std::max(0.0f, samples.directions[i].y);
    squares += one * one / static_cast<double>(samples.directions.size());
    largest = std::max(largest, one);
  }
  EXPECT_LT(squares, 0.8 * squares_by_area);
  EXPECT_LT(largest, 50 * expected);
}

}  // namespace
}  // namespace dapple
