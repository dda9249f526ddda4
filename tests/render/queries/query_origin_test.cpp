// Where rays of queries start: above the surface on which a caller's points lie, and close to it,
// also far from the origin.
#include <gtest/gtest.h>

#include "render/queries/point_occlusion.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// The mean AO of points on a ground around `at`, below a sheet that hides the middle of their sky.
/// `placed`: beside an object that is placed twice, so that there is a top level. `has_planes`: as
/// QueryPoints has it.
double ao_below_a_sheet(const V3f& at, bool placed, bool has_planes) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  M44f far;
  far.translate(at);
  place(scene, square_mesh(20, 0, 1, 0), far);
  place(scene, square_mesh(400, 0.5f, 1, 0), far);
  if (placed) {
    const Mesh leaves = square_mesh(1, 9, 20, 0);
    for (const float x : {900.0f, 905.0f}) {
      M44f beside;
      beside.translate(at + V3f(x, 0, 0));
      place(scene, leaves, beside);
    }
  }
  merge_single_instances(scene);
  const SceneOnDevice traced(std::move(scene));
  OcclusionOptions options;
  options.rays = 4096;
  options.estimator = Estimator::exact;
  options.distance = 1;
  const std::vector<V3f> points{at}, normals{{0, 1, 0}};
  const QueryPoints query{points, normals, {}, {}, has_planes};
  return point_occlusion(device(), traced.uploaded, query, options, false, {}).ao.at(0);
}

TEST(QueryOrigin, AoOfAGroundFarAlongAnAxisIsThatAtTheOrigin) {
  for (const float x : {0.0f, 3e3f, 1e5f, 4.5e6f})
    EXPECT_NEAR(ao_below_a_sheet({x, 0, 0}, false, true), 0.25, 0.01) << x;
}

TEST(QueryOrigin, OfOtherPointsAndBesideInstancesRaysStartByRoundingsOfTheLargestCoordinate) {
  for (const float x : {0.0f, 3e3f, 1e4f}) {
    EXPECT_NEAR(ao_below_a_sheet({x, 0, 0}, true, true), 0.25, 0.02) << x;
    EXPECT_NEAR(ao_below_a_sheet({x, 0, 0}, false, false), 0.25, 0.02) << x;
  }
}

TEST(QueryOrigin, PointsOfATiltedGroundAreNotHiddenByItAtAnyPlace) {
  Points random(3);
  for (const float side : {1e-2f, 1.0f, 1e5f})
    for (const V3f& at : {V3f(1, 2, 3), V3f(-100, 0, 30)})
      for (const float angle : {0.01f, 0.8f, 2.2f}) {
        M44f turn;
        turn.setAxisAngle(V3f(1, angle, -0.3f).normalized(), angle);
        Scene scene;
        scene.materials.push_back(material_of(1));
        Mesh ground = square_mesh(side, 0, 4, 0);
        for (V3f& p : ground.positions) p = p * turn + at * side;
        std::vector<V3f> points, normals;
        for (std::size_t t = 0; t < ground.indices.size(); t += 3) {
          const V3f& a = ground.positions[ground.indices[t]];
          const V3f edge1 = ground.positions[ground.indices[t + 1]] - a;
          const V3f edge2 = ground.positions[ground.indices[t + 2]] - a;
          for (int i = 0; i < 8; ++i) {
            const float u = random.unit(), v = (1 - u) * random.unit();
            points.push_back(a + edge1 * u + edge2 * v);
            normals.push_back(edge1.cross(edge2).normalized());
          }
        }
        place(scene, std::move(ground));
        const SceneOnDevice traced(std::move(scene));
        OcclusionOptions options;
        options.rays = 64;
        options.estimator = Estimator::exact;
        for (const bool has_planes : {true, false}) {
          const QueryPoints query{points, normals, {}, {}, has_planes};
          const std::vector<float> ao =
              point_occlusion(device(), traced.uploaded, query, options, false, {}).ao;
          EXPECT_EQ(*std::min_element(ao.begin(), ao.end()), 1)
              << side << ' ' << at << ' ' << angle;
        }
      }
}

/// On a slope of 1 in 2: points, and what part of the hemisphere about +Y lies above it.
TEST(QueryOrigin, PointsWithOtherNormalsThanTheirSurfaceAreNotHiddenByIt) {
  constexpr double kOpen = 0.5 + 0.5 * 0.894427;  // (1 + cos of the slope) / 2
  for (const float x : {0.0f, 100.0f, 1e4f}) {
    Scene scene;
    scene.materials.push_back(material_of(1));
    Mesh ground = square_mesh(20, 0, 8, 0);
    for (V3f& p : ground.positions) p = V3f(p.x + x, 0.5f * p.x, p.z);
    place(scene, std::move(ground));
    const SceneOnDevice traced(std::move(scene));
    Points random(5);
    std::vector<V3f> points;
    for (int i = 0; i < 400; ++i) {
      const float along = 18 * random.unit() - 9;
      points.emplace_back(along + x, 0.5f * ((along + x) - x), 18 * random.unit() - 9);
    }
    OcclusionOptions options;
    options.rays = 256;
    options.estimator = Estimator::exact;
    const std::vector<float> ao = occlusion(device(), traced.uploaded, points,
                                            std::vector(points.size(), V3f(0, 1, 0)), options);
    for (const float value : ao) EXPECT_NEAR(value, kOpen, 0.02) << x;
  }
}

}  // namespace
}  // namespace dapple
