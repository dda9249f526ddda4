// Points that commands make themselves: grids, and the sides of triangles.
#include "points/point_sources.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "dapple/error.hpp"
#include "dapple/points.hpp"

namespace dapple {
namespace {

TEST(PointSources, AGridHasItsLastRowAndColumnAndFacesUp) {
  const PointList list = grid_points({0, 0, 1, 0.3, 0.1}, 2);
  EXPECT_EQ(list.points.size(), 11u * 4u);
  EXPECT_LT((list.points.back() - V3f(1, 2, 0.3f)).length(), 1e-6f);
  EXPECT_THROW(grid_points({0, 0, 1, 1, 0}, 0), Error);
  EXPECT_THROW(grid_points({1, 0, 0, 1, 0.1}, 0), Error);
}

/// The triangle (0,0,0) (3,0,0) (0,3,0), and one without an area.
Scene triangle_placed_by(const M44f& to_world) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {6, 0, 0}};
  mesh.indices = {0, 1, 2, 0, 1, 3};
  mesh.materials = {0, 0};
  scene.materials.resize(1);
  scene.meshes = {mesh};
  scene.instances.resize(1);
  scene.instances[0].to_world = to_world;
  return scene;
}

void expect_front_then_back(const PointList& list, const V3f& centre, const V3f& front) {
  ASSERT_EQ(list.points.size(), 2u);
  ASSERT_EQ(list.normals.size(), 2u);
  for (const V3f& point : list.points) EXPECT_LT((point - centre).length(), 1e-5f);
  EXPECT_EQ(list.normals[0], front);
  EXPECT_EQ(list.normals[1], -front);
}

TEST(PointSources, ATriangleWithAnAreaHasItsCentreForItsFrontAndThenItsBack) {
  M44f moved;
  moved.setTranslation(V3f(0, 0, 5));
  expect_front_then_back(triangle_points(triangle_placed_by(moved)), V3f(1, 1, 5), V3f(0, 0, 1));
}

TEST(PointSources, ATriangleTellsItsInstanceMaterialSideAndArea) {
  M44f larger;
  larger.setScale(V3f(2, 2, 2));
  Scene scene = triangle_placed_by(larger);
  scene.materials.resize(2);
  scene.meshes[0].materials[0] = 1;
  scene.instances.insert(scene.instances.begin(), Instance());
  const PointList list = triangle_points(scene);
  ASSERT_EQ(list.points.size(), 4u);
  const std::vector<std::pair<std::string, std::vector<double>>> expected = {
      {"instance", {0, 0, 1, 1}},
      {"material", {1, 1, 1, 1}},
      {"side", {1, -1, 1, -1}},
      {"area", {4.5, 4.5, 18, 18}}};
  ASSERT_EQ(list.extra.size(), expected.size());
  for (std::size_t c = 0; c < expected.size(); ++c) {
    EXPECT_EQ(list.extra[c].name, expected[c].first);
    EXPECT_EQ(list.extra[c].values, expected[c].second) << list.extra[c].name;
  }
}

TEST(PointSources, TheFrontOfATriangleStaysTheFrontWhereItIsMirrored) {
  M44f mirror;
  mirror.setScale(V3f(-1, 1, 1));
  expect_front_then_back(triangle_points(triangle_placed_by(mirror)), V3f(-1, 1, 0), V3f(0, 0, 1));
  mirror.setScale(V3f(1, 1, -1));
  expect_front_then_back(triangle_points(triangle_placed_by(mirror)), V3f(1, 1, 0), V3f(0, 0, -1));
  M44f half_a_turn;  // two mirrors
  half_a_turn.setScale(V3f(-1, 1, -1));
  expect_front_then_back(triangle_points(triangle_placed_by(half_a_turn)), V3f(-1, 1, 0),
                         V3f(0, 0, -1));
}

TEST(PointSources, PointsOfLargeTrianglesNearTheOriginLieAboveThem) {
  std::mt19937 bits(3);
  std::uniform_real_distribution<float> coordinate(-600, 600);
  PointOptions options;
  options.sky_view_factor = false;
  options.estimator = Estimator::exact;
  options.rays = 16;
  for (int i = 0; i < 20; ++i) {
    Scene scene = triangle_placed_by(M44f());
    std::vector<V3f>& corners = scene.meshes[0].positions;
    for (V3f* corner : {&corners[0], &corners[1]})
      *corner = V3f(coordinate(bits), coordinate(bits), coordinate(bits));
    corners[2] = V3f(0.2f, -0.1f, 0.3f) - corners[0] - corners[1];
    corners[3] = corners[0];
    const PointList list = triangle_points(scene);
    ASSERT_EQ(list.points.size(), 2u);
    const PointResult result = measure_points(scene, list.points, list.normals, options);
    ASSERT_EQ(result.columns.at(0).name, "ao");
    EXPECT_EQ(result.columns[0].values, std::vector<float>(2, 1.0f)) << i;
  }
}

TEST(PointSources, StrandsHaveNoPointsAndThatIsNoted) {
  const Scene scene = make_procedural("scene:hair?strands=10");
  const PointList list = triangle_points(scene);
  EXPECT_FALSE(list.points.empty()) << "of the head";
  EXPECT_EQ(list.notes, std::vector<std::string>{"1 placed mesh of strands: no points on it"});
  EXPECT_TRUE(triangle_points(make_procedural("scene:cube")).notes.empty());
}

TEST(PointSources, TooManySidesAreAnError) {
  Scene scene = triangle_placed_by(M44f());
  scene.meshes[0].indices.resize(3'000'000);
  scene.meshes[0].materials.resize(1'000'000);
  scene.instances.resize(60);
  try {
    triangle_points(scene);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("have 1.2e+08 sides; points may be at most 1e+08"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace dapple
