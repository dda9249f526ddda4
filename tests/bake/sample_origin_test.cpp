// Where rays of bakes start: above their own triangles, also where coordinates are small sums of
// large terms.
#include <gtest/gtest.h>

#include <algorithm>

#include "dapple/bake.hpp"
#include "support/scene_on_device.hpp"

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
  const BakeResult result = bake(scene, options);
  EXPECT_EQ(result.statistics.hidden_vertices, 0u);
  EXPECT_EQ(result.statistics.hidden_texels, 0u);
  const std::vector<float>& vertices = result.meshes.at(0).ao;
  const std::vector<float>& texels = result.texture.ao;
  return std::min(*std::min_element(vertices.begin(), vertices.end()),
                  *std::min_element(texels.begin(), texels.end()));
}

// The vertices are at 0 in the world, and points of the triangles at the rounding of 0.1 - 0.1.
TEST(BakeSampleOrigin, ATopThatANodeMovesToZeroSeesTheSky) {
  for (const float height : {0.1f, 1.2f, 5.0f, 1000.0f})
    EXPECT_EQ(darkest(square_mesh(1, height, 4, 0), M44f().setTranslation(V3f(0, -height, 0))), 1)
        << height;
}

TEST(BakeSampleOrigin, ALargeTiltedSheetSeesTheSkyNearTheOrigin) {
  M44f tilted;
  tilted.rotate(V3f(0.3f, 0.2f, 0.7f));
  Mesh mesh = square_mesh(2000, 0, 1, 0);
  for (V3f& p : mesh.positions) p = p * tilted;
  EXPECT_EQ(darkest(mesh, {}), 1);
}

}  // namespace
}  // namespace dapple
