// Where rays of bakes start: above their own triangles, also where coordinates are small sums of
// large terms.
#include <gtest/gtest.h>

#include <algorithm>

#include "dapple/bake.hpp"
#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// The darkest baked value of a sheet alone, at its vertices and in a texture.
float darkest(const Mesh& mesh, const M44f& to_world) {
  Scene scene;
  scene.materials.resize(1);
  place(scene, mesh, to_world);
  BakeOptions options;
  options.estimator = Estimator::exact;
  options.texture = true;
  options.texture_size = 64;
  BakeResult result = bake(scene, options);
  EXPECT_EQ(result.statistics.enclosed_vertices, 0u);
  EXPECT_EQ(result.statistics.enclosed_texels, 0u);
  std::vector<float> values = result.meshes.at(0).ao;
  values.insert(values.end(), result.texture.ao.begin(), result.texture.ao.end());
  options.texture = false;
  options.at_vertices = true;
  result = bake(scene, options);
  values.insert(values.end(), result.meshes.at(0).ao.begin(), result.meshes.at(0).ao.end());
  return *std::min_element(values.begin(), values.end());
}

// The vertices are at 0 in the world, and points of the triangles at the rounding of 0.1 - 0.1.
TEST(BakeSampleOrigin, ATopThatANodeMovesToZeroSeesTheSky) {
  for (const float height : {0.1f, 1.2f, 5.0f, 1000.0f})
    EXPECT_EQ(darkest(square_mesh(1, height, 4, 0), M44f().setTranslation(V3f(0, -height, 0))), 1)
        << height;
}

// A square in map coordinates that a node moves home, before a wall 1 m away.
TEST(BakeSampleOrigin, OccludersNearAMeshInMapCoordinatesCount) {
  Scene scene;
  scene.materials.resize(1);
  Mesh floor = square_mesh(0.5f, 500'000, 1, 0);
  const std::size_t at = place(scene, floor, M44f().setTranslation(V3f(0, -500'000, 0)));
  place(scene, square_mesh(100, 1, 1, 0));
  BakeOptions options;
  options.estimator = Estimator::exact;
  const BakeResult result = bake(scene, options);
  for (const float ao : not_empty(result.meshes.at(scene.instances[at].mesh).ao))
    EXPECT_LT(ao, 0.1f);
}

TEST(BakeSampleOrigin, ALargeTiltedSheetSeesTheSkyNearTheOrigin) {
  M44f tilted;
  tilted.rotate(V3f(0.3f, 0.2f, 0.7f));
  Mesh mesh = square_mesh(2000, 0, 2, 0);  // a vertex is at the origin
  for (V3f& p : mesh.positions) p = p * tilted;
  EXPECT_EQ(darkest(mesh, {}), 1);
}

}  // namespace
}  // namespace dapple
