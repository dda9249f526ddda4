// Where rays of queries start: above the surface on which a caller's points lie, and close to it,
// also far from the origin.
#include <gtest/gtest.h>

#include "support/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// The mean AO of points on a ground around `at`, below a sheet that hides the middle of their sky.
/// `placed`: another object makes both objects of a top level.
double ao_below_a_sheet(const V3f& at, bool placed) {
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
  return traced.occlusion_at(at, {0, 1, 0}, options);
}

TEST(QueryOrigin, AoOfAGroundFarAlongAnAxisIsThatAtTheOrigin) {
  for (const float x : {0.0f, 3e3f, 1e5f, 4.5e6f})
    EXPECT_NEAR(ao_below_a_sheet({x, 0, 0}, false), 0.25, 0.01) << x;
}

TEST(QueryOrigin, BesideInstancesRaysStartByRoundingsOfTheLargestCoordinate) {
  for (const float x : {0.0f, 3e3f, 2e4f})
    EXPECT_NEAR(ao_below_a_sheet({x, 0, 0}, true), 0.25, 0.02) << x;
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
        const std::vector<float> ao =
            occlusion(device(), traced.uploaded, points, normals, options);
        EXPECT_EQ(*std::min_element(ao.begin(), ao.end()), 1) << side << ' ' << at << ' ' << angle;
      }
}

}  // namespace
}  // namespace dapple
