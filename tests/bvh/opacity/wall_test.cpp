// Walls: which triangles lie inside an opaque surface, which nodes count as walls, and that
// refitting keeps them.
#include "bvh/opacity/wall.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "bvh/opacity/welded_vertices.hpp"
#include "dapple/bvh.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"
#include "support/scenes/split_vertices.hpp"

namespace dapple {
namespace {

using namespace scene_test;

std::vector<float> chords_of(const Mesh& mesh, const std::vector<float>& opacities) {
  const OpaqueTriangles opaque(mesh, opacities);
  return interior_triangles(opaque, welded_vertices(opaque.positions(), opaque.indices()));
}

std::ptrdiff_t count_interior(const Mesh& mesh, float opacity = 1.0f) {
  const std::vector<float> opacities(mesh.indices.size() / 3, opacity);
  const std::vector<float> chords = chords_of(mesh, opacities);
  return std::count_if(chords.begin(), chords.end(), [](float chord) { return chord > 0; });
}

TEST(InteriorTriangles, AreAllOfAClosedSurface) {
  const Mesh sphere = test::smooth_sphere();
  EXPECT_EQ(count_interior(sphere), static_cast<std::ptrdiff_t>(sphere.indices.size() / 3));
}

TEST(InteriorTriangles, AreFoundByPositionsNotIndices) {
  const Mesh sphere = test::with_split_vertices(test::smooth_sphere());
  EXPECT_EQ(count_interior(sphere), static_cast<std::ptrdiff_t>(sphere.indices.size() / 3));
}

TEST(InteriorTriangles, DoNotTouchTheBorderOfASmallSheet) {
  Mesh grid;
  append_grid(grid, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 6, 0);
  EXPECT_EQ(count_interior(grid), 2 * 4 * 4);
}

// 36 of 64 quads do not touch the border: more than half of each sheet, with the vertices of
// neighbours or with vertices of their own.
TEST(InteriorTriangles, ReachTheBorderOfALargeSheet) {
  Mesh sheets;
  append_grid(sheets, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 8, 0);
  append_grid(sheets, {0, 3, 0}, {1, 0, 0}, {0, 0, 1}, 4, 0);
  EXPECT_EQ(count_interior(sheets), 2 * 8 * 8 + 2 * 2 * 2) << "a small sheet beside it";
  // Two triangles have all their corners on the border: they are found by their neighbours'
  // vertices.
  EXPECT_EQ(count_interior(test::with_split_vertices(sheets)), 2 * 8 * 8 - 2 + 2 * 2 * 2);
}

// Ivy has ten times the area of the wall that it grows on.
TEST(Wall, IsCoveredByThePartOfAWallWhateverElseIsInIt) {
  WallAreas areas;
  NormalMoments normals;
  areas.add(V3f(0, 0, 1), 1.0f, 2.0f);
  for (int i = 0; i < 10; ++i) areas.add(V3f(0.5f, 0.7f, 0.5f), 1.0f, 0.0f);
  for (int axis = 0; axis < 3; ++axis) normals.sum[static_cast<std::size_t>(axis)] = 1;
  const Box3f box(V3f(0, 0, 0), V3f(1, 1, 0.1f));
  EXPECT_TRUE(is_wall(areas, normals, box));
  EXPECT_TRUE(is_wall(areas, normals, {box.min, V3f(1, 10, 0.1f)}));
  EXPECT_FALSE(is_wall(areas, normals, {box.min, V3f(1, 30, 0.1f)})) << "it covers a thirtieth";
}

TEST(InteriorTriangles, AreNoneOfLeavesAndOfTranslucentSurfaces) {
  Mesh leaves;
  for (int i = 0; i < 8; ++i) {
    append_grid(leaves, V3f(static_cast<float>(i), 0, 0), {1, 0, 1}, {0, 1, 1}, 2, 0);
  }
  EXPECT_EQ(count_interior(leaves), 0);
  EXPECT_EQ(count_interior(test::smooth_sphere(), 0.99f), 0);
}

/// The chord of all interior triangles, which must be one surface.
float chord_of(const Mesh& mesh) {
  const std::vector<float> ones(mesh.indices.size() / 3, 1.0f);
  const std::vector<float> chords = chords_of(mesh, ones);
  EXPECT_EQ(std::count(chords.begin(), chords.end(), chords[0]), std::ssize(chords));
  return chords[0];
}

// 4/3 of the radius (Cauchy). Turned inside out, and far away, it is the same.
TEST(InteriorTriangles, HaveTheMeanChordOfASphere) {
  Mesh sphere = test::smooth_sphere(120, 60);
  EXPECT_NEAR(chord_of(sphere), 4.0 / 3, 0.005);
  for (std::size_t t = 0; t < sphere.indices.size(); t += 3)
    std::swap(sphere.indices[t], sphere.indices[t + 1]);
  for (V3f& p : sphere.positions) p = 10.0f * p + V3f(1000, -2000, 500);
  EXPECT_NEAR(chord_of(sphere), 40.0 / 3, 0.05);
}

// As of careless exporters: every other triangle faces the other side, or all of one half do.
TEST(InteriorTriangles, HaveTheMeanChordOfASphereWhoseTrianglesFaceBothSides) {
  const Mesh sphere = test::smooth_sphere(120, 60);
  for (const bool halves : {false, true}) {
    Mesh turned = sphere;
    for (std::size_t t = 0; t < turned.indices.size() / 3; ++t)
      if (halves ? t < turned.indices.size() / 6 : t % 2 == 0)
        std::swap(turned.indices[3 * t], turned.indices[3 * t + 1]);
    EXPECT_NEAR(chord_of(turned), 4.0 / 3, 0.005) << halves;
  }
}

// As of programs that write each triangle for both of its sides.
TEST(InteriorTriangles, HaveTheMeanChordOfASphereWhoseTrianglesAreThereTwice) {
  Mesh sphere = test::smooth_sphere(120, 60);
  for (V3f& p : sphere.positions) p += V3f(3, -7, 2);
  const std::vector<std::uint32_t> once = sphere.indices;
  for (std::size_t i = 0; i < once.size(); i += 3)
    sphere.indices.insert(sphere.indices.end(), {once[i], once[i + 2], once[i + 1]});
  EXPECT_NEAR(chord_of(sphere), 4.0 / 3, 0.005);
}

// Its triangles are smaller than a step of the coarse grid over all surfaces.
TEST(InteriorTriangles, AreFoundInASmallHouseOnALargeTerrain) {
  Mesh mesh = test::smooth_sphere(120, 60);
  const auto interior = static_cast<std::ptrdiff_t>(mesh.indices.size() / 3);
  EXPECT_EQ(count_interior(mesh), interior);
  append_grid(mesh, {-10000, -1, -10000}, {20000, 0, 0}, {0, 0, 20000}, 1, 0);
  EXPECT_EQ(count_interior(mesh), interior);
}

// The diameter of its tube, however large the ring is.
TEST(InteriorTriangles, HaveTheMeanChordOfATorus) {
  EXPECT_NEAR(chord_of(test::smooth_torus(120, 60).meshes[0]), 0.8, 0.004);
}

// Flat sheets enclose nothing.
TEST(InteriorTriangles, OfASheetHaveAChordOfNothing) {
  Mesh sheet;
  append_grid(sheet, {5, 1, 7}, {1, 0, 0}, {0, 0, 1}, 8, 0);
  EXPECT_LT(chord_of(sheet), 1e-5);
}

/// Sums over triangles of given area vectors.
struct Sums {
  WallAreas areas;
  NormalMoments normals;
  float chord = 1e-30f;
  void add(const V3f& area, bool interior = true) {
    areas.add(area, 1.0f, interior ? chord : 0);
    normals.add(area, 1.0f);
  }
  [[nodiscard]] bool wall(float extent = 1) const {
    return is_wall(areas, normals, {V3f(0, 0, 0), V3f(0.5f, extent, 0.2f)});
  }
};

TEST(Wall, IsOneSideOfASurfaceOrFlat) {
  Sums one, corner, slab, tube, sphere_half;
  one.add({0, 0, 1});
  for (const V3f& n : {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)}) corner.add(n);
  for (const float z : {1.0f, -1.0f}) slab.add({0, 0, z});
  for (int i = 0; i < 12; ++i) {
    const auto angle = static_cast<float>(i * kPi / 6);
    tube.add({std::cos(angle), std::sin(angle), 0});
  }
  EXPECT_TRUE(one.wall());
  EXPECT_TRUE(corner.wall());
  EXPECT_TRUE(slab.wall());
  EXPECT_FALSE(tube.wall());
  EXPECT_FALSE(Sums().wall());
}

TEST(Wall, IsSmallInsideWhatItsSurfacesEnclose) {
  Sums pillar;
  pillar.chord = 2;
  for (const float side : {1.0f, -1.0f}) {
    pillar.add({side, 0, 0});
    pillar.add({0, 0, side});
    pillar.add({0, side, 0});
  }
  EXPECT_TRUE(pillar.wall(7.9f));
  EXPECT_FALSE(pillar.wall(8.1f));
}

TEST(Wall, HasMostlyInteriorTriangles) {
  Sums mixed;
  mixed.add({0, 0, 1});
  mixed.add({0, 0, -1});
  EXPECT_TRUE(mixed.wall());
  mixed.add({0, 0, 2.1f}, false);
  EXPECT_FALSE(mixed.wall());
}

/// Number of children that are walls.
int walls_of(const SceneBvh& bvh) {
  int walls = 0;
  for (const BvhNode& node : bvh.nodes)
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot)
      walls += bvh_is_wall(node.depth, slot) ? 1 : 0;
  return walls;
}

TEST(Wall, NodesOfASphereAreWallsAndThoseOfLeavesAreNot) {
  EXPECT_GT(walls_of(build_bvh(test::scene_of(test::smooth_sphere(60, 30)))), 100);
  EXPECT_EQ(walls_of(build_bvh(make_procedural("scene:cloud?leaves=2000&opacity=1"))), 0);
}

TEST(Wall, RefittingKeepsWalls) {
  Scene scene = test::scene_of(test::smooth_sphere(60, 30));
  UpdatableBvh bvh(scene);
  const int before = walls_of(bvh.bvh());
  for (V3f& p : scene.meshes[0].positions) p = V3f(1.3f * p.x, p.y, p.z + 0.1f * p.x);
  bvh.update(scene);
  EXPECT_EQ(walls_of(bvh.bvh()), before);
}

}  // namespace
}  // namespace dapple
