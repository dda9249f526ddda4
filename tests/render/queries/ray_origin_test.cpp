// Where rays of AO and lights start: so close to the surface that they meet what lies just above
// it, also on large triangles and far from the origin.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

TEST(RayOrigin, APlateAMillimetreAboveATriangleOfTwoKilometresHidesItsSky) {
  Scene scene = point_on_ground();
  scene.meshes[0] = square_mesh(2000, 0, 1, 0);
  place(scene, square_mesh(2, 1e-3f, 1, 0));
  scene.cameras[0] = look_at({0, 5e-4f, 0}, {0, 0, 0}, {0, 0, -1}, 1);
  EXPECT_NEAR(value(render(scene, one_pixel()).film, "ao.R"), 0, 1e-5);
}

/// A ground of `side` metres around `at`, turned about `axis` by `angle`, of triangles that are
/// `aspect` times as long as wide.
Scene tilted_ground(float side, const V3f& at, const V3f& axis, float angle, float aspect = 1) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  M44f turn;
  turn.setAxisAngle(axis.normalized(), angle);
  Mesh ground = square_mesh(side, 0, 8, 0);
  for (V3f& p : ground.positions) p = V3f(p.x, p.y, p.z / aspect) * turn + at;
  place(scene, std::move(ground));
  const V3f up = V3f(0, 1, 0) * turn;
  scene.cameras.push_back(look_at(at + up * (side / aspect), at, V3f(1, 0, 0) * turn, 0.8f));
  return scene;
}

TEST(RayOrigin, APlaneDoesNotHideItselfAtAnyTiltSizeOrPlace) {
  RenderOptions options = one_pixel();
  options.width = options.height = 24;
  options.ao_rays = 64;
  Renderer renderer;
  for (const Packets packets : {Packets::automatic, Packets::scalar}) {
    options.packets = packets;
    for (const float side : {1e-3f, 1e6f})
      for (const V3f& at : {V3f(1, 2, 3), V3f(-100, 0, 30)})
        for (const float angle : {0.01f, 2.2f}) {
          Scene scene = tilted_ground(side, side * at, V3f(1, angle, -0.3f), angle);
          const Film film = renderer.render(std::move(scene), options).film;
          const auto& ao = film.find("ao.R")->pixels;
          EXPECT_EQ(*std::min_element(ao.begin(), ao.end()), 1)
              << side << ", " << at << ", " << angle;
        }
  }
}

TEST(RayOrigin, GentleSlopesOfNeedlesDoNotHideThemselves) {
  RenderOptions options = one_pixel();
  options.width = options.height = 24;
  options.ao_rays = 64;
  Renderer renderer;
  for (const float angle : {0.01f, 0.1f, 0.8f})
    for (const float aspect : {100.0f, 1000.0f}) {
      Scene scene = tilted_ground(100, {0, 0, 20}, V3f(0.4f, 0, 1), angle, aspect);
      const Film film = renderer.render(std::move(scene), options).film;
      const auto& ao = film.find("ao.R")->pixels;
      EXPECT_EQ(*std::min_element(ao.begin(), ao.end()), 1) << angle << ", " << aspect;
    }
}

/// The ground, and above it a sheet that hides the middle of the sky: of directions by cosine those
/// that reach it within a metre are 3/4.
Scene below_a_sheet(float x) {
  Scene scene = point_on_ground();
  M44f far;
  far.translate(V3f(x, 0, 0));
  for (Instance& instance : scene.instances) instance.to_world = far;
  place(scene, square_mesh(400, 0.5f, 1, 0), far);
  scene.cameras[0].to_world = scene.cameras[0].to_world * far;
  return scene;
}

TEST(RayOrigin, AoOfAGroundFarAlongAnAxisIsThatAtTheOrigin) {
  for (const float x : {0.0f, 2e4f, 5e5f, 4.5e6f}) {
    RenderOptions options = one_pixel();
    options.ao_distance = 1;
    Scene scene = below_a_sheet(x);
    scene.cameras[0].to_world[3][1] = 0.25f;
    const RenderResult result = render(scene, options);
    EXPECT_NEAR(value(result.film, "ao.R"), 0.25, 0.01) << x;
    const bool warned = std::any_of(
        result.statistics.notes.begin(), result.statistics.notes.end(),
        [](const std::string& note) { return note.find("from the origin") != std::string::npos; });
    EXPECT_EQ(warned, x > 1e5f) << x;
  }
}

}  // namespace
}  // namespace dapple
