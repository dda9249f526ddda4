// Closed surfaces let no ray out: not through the edges that triangles share (Woop, Benthin and
// Wald, "Watertight Ray/Triangle Intersection", 2013), and not where footprints cover parts of a
// wall (host/bvh/opacity/wall.hpp). What comes out must be 0 to the last bit.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// The six sides of the unit cube, of 64x64 quads each, whose seams have equal positions. In the
/// side z = 1, quads with `is_open` are missing.
template <class IsOpen>
Mesh room(const IsOpen& is_open) {
  constexpr int kQuads = 64;
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Mesh mesh;
  for (const auto& [corner, u, v] :
       {std::array{V3f(0, 0, 0), x, y}, std::array{V3f(0, 0, 0), y, z},
        std::array{V3f(0, 0, 0), z, x}, std::array{x, y, z}, std::array{y, z, x}}) {
    append_grid(mesh, corner, u, v, kQuads, 0);
  }
  const std::size_t before = mesh.indices.size();
  append_grid(mesh, z, x, y, kQuads, 0);
  std::vector<std::uint32_t> kept(mesh.indices.begin(),
                                  mesh.indices.begin() + static_cast<std::ptrdiff_t>(before));
  for (int quad = 0; quad < kQuads * kQuads; ++quad) {
    if (is_open(quad % kQuads, quad / kQuads)) continue;
    const std::size_t at = before + 6 * static_cast<std::size_t>(quad);
    kept.insert(kept.end(), mesh.indices.begin() + static_cast<std::ptrdiff_t>(at),
                mesh.indices.begin() + static_cast<std::ptrdiff_t>(at) + 6);
  }
  mesh.indices = kept;
  mesh.materials.resize(kept.size() / 3);
  return mesh;
}

Mesh closed_room() {
  return room([](int, int) { return false; });
}

/// No axis of the room is parallel to an axis of the boxes any more.
Mesh turned(Mesh mesh) {
  M44f matrix;
  matrix.rotate(V3f(0.4f, 0.3f, 0.5f));
  for (V3f& p : mesh.positions) p = p * matrix;
  return mesh;
}

/// Rays in all directions from points in the middle of the mesh, `per_point` from each.
std::vector<Ray> rays_from_inside(const Mesh& mesh, std::size_t count, std::size_t per_point,
                                  float solid_angle) {
  V3f centre(0, 0, 0);
  for (const V3f& p : mesh.positions) centre += p / static_cast<float>(mesh.positions.size());
  Points points(3);
  std::vector<Ray> rays;
  V3f origin = centre;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % per_point == 0) origin = centre + points.in_cube(0.3f);
    // Half of the rays aim at corners and edges of triangles, to within roundings.
    const std::size_t t = i * 7919 % (mesh.indices.size() / 3);
    const V3f& a = mesh.positions[mesh.indices[3 * t]];
    const V3f& b = mesh.positions[mesh.indices[3 * t + 1]];
    const float share = i % 4 ? points.unit() : 0.0f;
    const V3f target = a + (b - a) * share;
    rays.push_back(make_ray(origin, i % 2 ? points.on_sphere() : target - origin, solid_angle));
  }
  return rays;
}

void expect_black(Mesh mesh) {
  const Mesh shape = mesh;
  const SceneOnDevice scene(test::scene_of(std::move(mesh)));
  for (const std::size_t per_point : {std::size_t{1}, std::size_t{64}}) {
    for (const float solid_angle : {1e-4f, 1e-2f, 0.1f, 1.0f}) {
      const auto rays = rays_from_inside(shape, 1 << 16, per_point, solid_angle);
      for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
        const auto found = trace(device(), scene.uploaded, rays, estimator, 4.0f, per_point);
        const auto escaped = std::count_if(found.begin(), found.end(), [](const Occlusion& one) {
          return one.transmittance != 0.0f;
        });
        EXPECT_EQ(escaped, 0) << per_point << " rays a point, solid angle " << solid_angle
                              << (estimator == Estimator::exact ? ", exact" : ", prefiltered");
      }
    }
  }
}

TEST(Watertight, NoRayLeavesAClosedRoom) { expect_black(closed_room()); }

TEST(Watertight, NoRayLeavesAClosedRoomThatIsTurned) { expect_black(turned(closed_room())); }

TEST(Watertight, NoRayLeavesASphere) { expect_black(test::smooth_sphere(240, 120)); }

TEST(Watertight, NoRayLeavesARoomOfTwelveTriangles) {
  Mesh mesh;
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), none(0, 0, 0);
  for (const auto& [corner, u, v] :
       {std::array{none, x, y}, std::array{none, y, z}, std::array{none, z, x}, std::array{x, y, z},
        std::array{y, z, x}, std::array{z, x, y}}) {
    append_grid(mesh, corner, u, v, 1, 0);
  }
  expect_black(turned(std::move(mesh)));
}

TEST(Watertight, LightComesThroughAWindowOnly) {
  const Mesh mesh = room([](int i, int j) { return i >= 20 && i < 44 && j >= 20 && j < 44; });
  for (const Mesh& placed : {mesh, turned(mesh)}) {
    const SceneOnDevice scene(test::scene_of(placed));
    const auto rays = rays_from_inside(placed, 1 << 16, 1, 0.05f);
    const double exact = mean_transmittance(scene.trace(rays, Estimator::exact));
    const double prefiltered = mean_transmittance(scene.trace(rays, Estimator::prefiltered, 4.0f));
    EXPECT_GT(exact, 0.01);
    // Triangles at the window's rim are parts of the wall, so that no light comes in beside it.
    EXPECT_NEAR(prefiltered, exact, 1e-6);
  }
}

}  // namespace
}  // namespace dapple
