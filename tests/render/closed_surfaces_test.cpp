// Inside of closed surfaces that curve, with and without things in them, no ray gets away, however
// wide its footprint is: a rough cave, a torus, a room of round walls full of balls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "dapple/render.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

/// A sphere of radius 1 or so whose wall has bumps, a third of a metre apart.
Scene rough_cave() {
  Mesh mesh = test::smooth_sphere(120, 60);
  for (V3f& p : mesh.positions)
    p *= 1.0f + 0.3f * std::sin(11 * p.x + 1) * std::sin(10 * p.y + 2) * std::sin(9 * p.z + 3);
  test::set_smooth_normals(mesh);
  return test::scene_of(std::move(mesh));
}

Scene torus() { return test::smooth_torus(160, 60); }

void append_ball(Mesh& mesh, const V3f& centre, float radius) {
  const Mesh ball = test::smooth_sphere();
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (const V3f& p : ball.positions) mesh.positions.push_back(centre + radius * p);
  mesh.normals.insert(mesh.normals.end(), ball.normals.begin(), ball.normals.end());
  for (const std::uint32_t index : ball.indices) mesh.indices.push_back(base + index);
}

/// Balls that touch its wall or lie near each other, so that nodes hold both.
Scene room_with_balls() {
  Mesh mesh = test::smooth_sphere(120, 60);
  for (int i = 0; i < 24; ++i) {
    const auto angle = static_cast<float>(i * std::numbers::pi / 12);
    append_ball(mesh, {0.8f * std::cos(angle), 0.2f * std::sin(5 * angle), 0.8f * std::sin(angle)},
                0.08f + 0.06f * std::sin(7 * angle));
  }
  return test::scene_of(std::move(mesh));
}

struct ClosedScene {
  std::string name;
  Scene (*make)();
  V3f eye, at;
};

void PrintTo(const ClosedScene& scene, std::ostream* out) { *out << scene.name; }

class ClosedSurfaces : public testing::TestWithParam<ClosedScene> {};

TEST_P(ClosedSurfaces, LetNoLightIn) {
  Scene scene = GetParam().make();
  scene.cameras = {look_at(GetParam().eye, GetParam().at, {0, 1, 0}, 1.6f)};
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 16;
  options.light = false;
  options.max_bias = 0.0f;
  Renderer renderer;  // keeps the BVH
  for (const float footprint : {1.0f, 4.0f, 64.0f}) {
    options.footprint = footprint;
    const Film film = renderer.render(scene, options).film;
    for (const float seen : film.find("A")->pixels) ASSERT_EQ(seen, 1);
    double sum = 0;
    for (const float value : film.find("ao.R")->pixels) sum += double{value};
    EXPECT_LT(sum / 4096, 1e-5) << "footprint " << footprint;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, ClosedSurfaces,
    testing::Values(ClosedScene{"cave", rough_cave, {0.1f, 0, 0.2f}, {-0.3f, -0.2f, -0.5f}},
                    ClosedScene{"torus", torus, {1, 0, 0}, {0.7f, 0, 1}},
                    ClosedScene{
                        "room", room_with_balls, {0.1f, 0.3f, 0.2f}, {-0.3f, -0.1f, -0.5f}}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace dapple
