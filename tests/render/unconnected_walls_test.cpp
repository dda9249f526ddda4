// Walls that are solid, but whose parts do not meet at common corners: overlapping panels, and
// bricks in running bond. dapple recognises walls by the corners of their triangles
// (bvh/opacity/wall.hpp), so these leak light with a kept footprint (docs/limits.md). The pilot of
// a default render finds that out. Quads with vertices of their own at common corners do not leak.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/compare_films.hpp"
#include "support/scenes/hard_scenes.hpp"

namespace dapple {
namespace {

using namespace hard_scenes;

enum class Parts { quads, panels, bricks };

/// A part of the wall corner + [0,1] u + [0,1] v. Corners that have equal coordinates are equal to
/// the last bit.
void append_quad(Mesh& mesh, V3f corner, V3f u, V3f v, V2f from, V2f to) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const V2f& at : {from, V2f(to.x, from.y), to, V2f(from.x, to.y)})
    mesh.positions.push_back(corner + u * at.x + v * at.y);
  for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + k);
}

/// As append_wall(), of quads with vertices of their own.
void append_parts(Mesh& mesh, Parts parts, V3f corner, V3f u, V3f v, const Hole& hole = {}) {
  constexpr float kPart = 1.0f / kQuads;
  const float overlap = parts == Parts::panels ? 0.01f : 0;
  for (int row = 0; row < kQuads; ++row) {
    const bool shifted = parts == Parts::bricks && row % 2 == 1;
    for (int column = shifted ? -1 : 0; column < kQuads; ++column) {
      if (hole && hole(column, row)) continue;
      const float left = static_cast<float>(column) + (shifted ? 0.5f : 0),
                  bottom = static_cast<float>(row);
      const V2f from(std::max(left - overlap, 0.0f), bottom - overlap),
          to(std::min(left + 1 + overlap, static_cast<float>(kQuads)), bottom + 1 + overlap);
      append_quad(mesh, corner, u, v, from * kPart, to * kPart);
    }
  }
}

/// Turns all positions, so that sides of boxes of the BVH do not lie in the walls.
void turn(Mesh& mesh, Camera& camera) {
  M44f turned;
  turned.setEulerAngles(V3f(0.3f, 0.5f, 0));
  for (V3f& position : mesh.positions) turned.multVecMatrix(V3f(position), position);
  camera.to_world = camera.to_world * turned;
}

/// Moves each coordinate to the next float in either direction, or not.
void round_otherwise(Mesh& mesh) {
  std::uint32_t random = 1;
  for (V3f& position : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      random = random * 1664525u + 1013904223u;
      if (const std::uint32_t way = (random >> 16) % 3; way < 2)
        position[axis] = std::nextafter(position[axis], way == 0 ? -9.0f : 9.0f);
    }
  }
}

Scene room_with_one_window(Parts parts) {
  const V3f x(2, 0, 0), y(0, 2, 0), z(0, 0, 4);
  Mesh mesh;
  append_parts(mesh, parts, {-1, 0, 0}, x, z);
  append_parts(mesh, parts, {-1, 2, 0}, x, z);
  append_parts(mesh, parts, {-1, 0, 0}, y, z);
  append_parts(mesh, parts, {1, 0, 0}, y, z);
  append_parts(mesh, parts, {-1, 0, 0}, x, y);
  append_parts(mesh, parts, {-1, 0, 4}, x, y,
               [](int i, int j) { return i >= 20 && i < 32 && j >= 24 && j < 40; });
  Camera camera = look_at({0.7f, 1.6f, 3.7f}, {-0.3f, 0.6f, 0}, {0, 1, 0}, 0.7f);
  turn(mesh, camera);
  Scene scene = test::scene_of(std::move(mesh));
  scene.cameras = {camera};
  return scene;
}

LayerDifference difference(const Scene& scene, const RenderOptions& options) {
  RenderOptions exact = options;
  exact.estimator = Estimator::exact;
  const Comparison compared =
      compare_test::compared(render(scene, options).film, render(scene, exact).film);
  const auto is_ao = [](const LayerDifference& one) { return one.layer == "ao"; };
  return *std::find_if(compared.layers.begin(), compared.layers.end(), is_ao);
}

LayerDifference with_kept_footprint(const Scene& scene) {
  RenderOptions options = picture_of("ao");
  options.spp = 64;
  EXPECT_FALSE(chooses_footprint(options));
  return difference(scene, options);
}

TEST(UnconnectedWalls, QuadsAtCommonCornersAreAWall) {
  EXPECT_LE(with_kept_footprint(room_with_one_window(Parts::quads)).rmse, 1e-5);
}

// As of a house whose walls, windows and plants share a texture.
TEST(UnconnectedWalls, WithOpaqueTexelsOfATextureThatHasOthersAreAWall) {
  Scene scene = room_with_one_window(Parts::quads);
  Mesh& mesh = scene.meshes[0];
  for (const V3f& position : mesh.positions)
    mesh.uvs.push_back(V2f(0.25f, 0.5f) + V2f(position.x, position.y + position.z) * 0.02f);
  Texture texture;
  texture.width = texture.height = 64;
  for (std::uint32_t texel = 0; texel < 64 * 64; ++texel)
    texture.alpha.push_back(texel % 64 < 32 ? 255 : 0);
  scene.textures = {texture};
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].alpha_texture = 0;
  EXPECT_LE(with_kept_footprint(scene).rmse, 1e-5);
}

// As files have them whose writer computed each corner's position more than once.
TEST(UnconnectedWalls, QuadsWhoseCornersDifferByARoundingErrorAreNearlyAWall) {
  Scene scene = room_with_one_window(Parts::quads);
  round_otherwise(scene.meshes[0]);
  const LayerDifference found = with_kept_footprint(scene);
  std::printf("corners that differ by a rounding error: mean %.5f, RMSE %.5f\n",
              found.mean_difference, found.rmse);
  EXPECT_LE(found.mean_difference, 0.002);
  EXPECT_LE(found.rmse, 0.005);
}

// If these fail because less light leaks, docs/limits.md says too much.
TEST(UnconnectedWalls, OthersLeakWithAKeptFootprint) {
  for (const Parts parts : {Parts::panels, Parts::bricks}) {
    const LayerDifference found = with_kept_footprint(room_with_one_window(parts));
    EXPECT_GT(found.mean_difference, 0.1);
    EXPECT_LT(found.mean_difference, 0.3);
  }
}

// The pilot takes exact rays.
TEST(UnconnectedWalls, AreDarkWhereTheRenderChoosesTheFootprint) {
  const RenderOptions options = picture_of("ao");
  ASSERT_TRUE(chooses_footprint(options));
  const LayerDifference found = difference(room_with_one_window(Parts::bricks), options);
  EXPECT_LE(std::fabs(found.mean_difference), 0.001);
  EXPECT_LE(found.rmse, 0.002);
  EXPECT_LE(found.window_rmse, 0.003);
}

}  // namespace
}  // namespace dapple
