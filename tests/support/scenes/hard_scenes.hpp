// Scenes that leak or darken where opacities of nodes are multiplied: closed and open tunnels, a
// room with one window, blinds, a hedge of aligned blades, walls of leaves with a lamp between
// them, a plate of holes, a field of grass of 100 m at a grazing angle; and a camera for each.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/render.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple::hard_scenes {

/// A scene with one camera, and the layers that are judged.
struct HardScene {
  Scene scene;
  std::vector<std::string> layers;
};

inline HardScene seen_from(V3f from, V3f at, Scene scene,
                           std::vector<std::string> layers = {"ao"}) {
  scene.cameras = {look_at(from, at, {0, 1, 0}, 0.7f)};
  return {std::move(scene), std::move(layers)};
}

inline constexpr int kQuads = 60;

/// Whether the quad (column, row) of a wall is missing.
using Hole = std::function<bool(int, int)>;

inline void append_wall(Mesh& mesh, V3f corner, V3f u, V3f v, const Hole& hole = {}) {
  Mesh wall;
  scene_test::append_grid(wall, corner, u, v, kQuads, 0);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), wall.positions.begin(), wall.positions.end());
  for (int quad = 0; quad < kQuads * kQuads; ++quad) {
    if (hole && hole(quad % kQuads, quad / kQuads)) continue;
    for (std::size_t k = 0; k < 6; ++k)
      mesh.indices.push_back(base + wall.indices[6 * static_cast<std::size_t>(quad) + k]);
  }
}

/// Two metres wide and high, from z = 0 to `length`, without its ends.
inline Mesh tunnel(float length) {
  const V3f x(2, 0, 0), y(0, 2, 0), z(0, 0, length);
  Mesh mesh;
  append_wall(mesh, {-1, 0, 0}, x, z);
  append_wall(mesh, {-1, 2, 0}, x, z);
  append_wall(mesh, {-1, 0, 0}, y, z);
  append_wall(mesh, {1, 0, 0}, y, z);
  return mesh;
}

inline Light lamp(V3f centre, V3f normal) {
  Light light;
  light.name = "lamp";
  light.kind = LightKind::rect;
  light.position = centre;
  light.direction = normal;
  light.edge_u = V3f(1.5f, 0, 0);
  light.edge_v = V3f(0, 1.5f, 0);
  light.radiance = V3f(1, 1, 1);
  return light;
}

inline HardScene closed_tunnel() {
  Mesh mesh = tunnel(10);
  append_wall(mesh, {-1, 0, 9}, {2, 0, 0}, {0, 2, 0});
  Scene scene = test::scene_of(std::move(mesh));
  scene.lights.push_back(lamp({0, 1, 10}, {0, 0, -1}));
  return seen_from({0, 1, 0.5f}, {0.1f, 0.9f, 9}, std::move(scene), {"light.lamp"});
}

inline HardScene open_tunnel() {
  Scene scene = test::scene_of(tunnel(10));
  scene.lights.push_back(lamp({0, 1, 10}, {0, 0, -1}));
  return seen_from({0, 1, 0.5f}, {0.1f, 0.9f, 9}, std::move(scene), {"ao", "light.lamp"});
}

inline HardScene room_with_one_window() {
  Mesh mesh = tunnel(4);
  append_wall(mesh, {-1, 0, 0}, {2, 0, 0}, {0, 2, 0});
  append_wall(mesh, {-1, 0, 4}, {2, 0, 0}, {0, 2, 0},
              [](int i, int j) { return i >= 20 && i < 32 && j >= 24 && j < 40; });
  return seen_from({0.7f, 1.6f, 3.7f}, {-0.3f, 0.6f, 0}, test::scene_of(std::move(mesh)));
}

inline HardScene blinds() {
  Mesh mesh;
  append_wall(mesh, {-1, 0, 0}, {2, 0, 0}, {0, 0, 2});
  for (int i = 0; i < 40; ++i)
    scene_test::append_grid(mesh, {-1, 0.05f * static_cast<float>(i), 2}, {2, 0, 0},
                            {0, 0.03f, 0.03f}, 4, 0);
  return seen_from({0, 1.5f, -2}, {0, 0.4f, 1.5f}, test::scene_of(std::move(mesh)));
}

/// Blades that all stand across x: seen from the side they hide what is behind, along x nothing.
inline HardScene hedge() {
  Mesh mesh;
  append_wall(mesh, {-4, 0, -4}, {8, 0, 0}, {0, 0, 8});
  scene_test::Points points(7);
  for (int i = 0; i < 4000; ++i) {
    const V3f at = points.in_cube(1);
    scene_test::append_grid(mesh, V3f(at.x, 0.5f * (at.y + 1), 0.3f * at.z), {0, 0, 0.04f},
                            {0, 0.1f, 0.01f}, 1, 0);
  }
  return seen_from({0.5f, 1.5f, -4}, {0, 0.4f, 0}, test::scene_of(std::move(mesh)));
}

/// A wall of leaves of any orientation, across z.
inline void append_leaves(Mesh& mesh, scene_test::Points& points, float z) {
  for (int i = 0; i < 3000; ++i) {
    const V3f at = points.in_cube(1), side = 0.05f * points.in_cube(1),
              other = 0.05f * points.in_cube(1);
    scene_test::append_grid(mesh, V3f(2 * at.x, at.y + 1, z + 0.15f * at.z), side, other, 1, 0);
  }
}

/// What the lamp between them sends through the walls is seen on the ground outside of them.
inline HardScene walls_of_leaves() {
  Mesh mesh;
  append_wall(mesh, {-4, 0, -4}, {8, 0, 0}, {0, 0, 8});
  scene_test::Points points(11);
  append_leaves(mesh, points, 0.8f);
  append_leaves(mesh, points, -0.8f);
  Scene scene = test::scene_of(std::move(mesh));
  scene.lights.push_back(lamp({0, 1.2f, 0.1f}, {0, 0, -1}));
  return seen_from({1, 2.5f, -4.5f}, {0, 0.4f, -1}, std::move(scene), {"ao", "light.lamp"});
}

/// With the camera that such scenes get.
inline HardScene plate_of_ten_thousand_holes() {
  Scene scene = make_procedural("scene:sieve");
  std::vector<std::string> notes;
  scene.cameras = {choose_view(scene, {}, notes).camera};
  return {std::move(scene), {"ao"}};
}

/// 100 m long.
inline HardScene grass_at_a_grazing_angle() {
  return {make_procedural("scene:grass?leaves=100000"), {"ao"}};
}

/// Of just as many samples as it takes for a render to choose its footprint.
inline RenderOptions picture_of(const std::string& layer) {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 256;
  options.report_bias = 0;
  options.albedo = false;
  options.ao = layer == "ao";
  options.light = !options.ao;
  return options;
}

}  // namespace dapple::hard_scenes
