// bake() into a texture: texels from which nothing is seen, and meshes in several poses.
#include <gtest/gtest.h>

#include <algorithm>

#include "bake/texture/texture_memory.hpp"
#include "dapple/bake.hpp"
#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = {std::move(mesh)};
  scene.instances.resize(1);
  return scene;
}

BakeOptions into_texture(std::uint32_t size) {
  BakeOptions options;
  options.vertices = false;
  options.texture = true;
  options.texture_size = size;
  return options;
}

TEST(BakeTexture, TexelsInsideClosedGeometryHaveTheNearestValueWhateverTheMargin) {
  const Scene cube = make_procedural("scene:cube?divisions=1");
  const Box3f bounds = scene_bounds(cube);
  const V3f size = bounds.size(), middle = bounds.center();
  // A floor through the middle of the cube, three times as wide.
  Mesh floor;
  append_grid(floor, middle - V3f(1.5f * size.x, 0, 1.5f * size.z), {0, 0, 3 * size.z},
              {3 * size.x, 0, 0}, 1, 0);
  BakeOptions options = into_texture(64);
  options.margin = 0;
  const BakeResult result = bake(scene_of(floor), options, {}, {cube});
  EXPECT_GT(result.statistics.enclosed_texels, 200u) << "a ninth of the texels";
  const std::vector<V2f>& corners = result.texture.layout.corners.at(0);
  V2f low(1), high(0);
  for (const V2f& corner : corners) {
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], corner[i]);
      high[i] = std::max(high[i], corner[i]);
    }
  }
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const V2f at((static_cast<float>(x) + 0.5f) / 64, (static_cast<float>(y) + 0.5f) / 64);
      const bool covered = at.x > low.x && at.x < high.x && at.y > low.y && at.y < high.y;
      if (!covered) continue;
      EXPECT_GT(result.texture.ao[y * 64 + x], 0.02f) << x << ", " << y;
    }
  }
}

// Look-ups at seams read texels beside the charts.
TEST(BakeTexture, TheMarginChangesNoTexelThatTrianglesCover) {
  const Scene scene = test::scene_of(test::smooth_sphere());
  Mesh below;
  append_grid(below, V3f(-9, scene_bounds(scene).min.y, -9), {0, 0, 18}, {18, 0, 0}, 1, 0);
  const Scene floor = scene_of(below);
  BakeOptions options = into_texture(64);
  options.target_error = 0;
  options.rays = 64;
  options.margin = 0;
  const BakedTexture without = bake(scene, options, {}, {floor}).texture;
  options.margin = 1;
  const BakedTexture with = bake(scene, options, {}, {floor}).texture;
  std::size_t covered = 0;
  for (std::size_t i = 0; i < with.ao.size(); ++i) {
    if (without.ao[i] == 1) continue;
    EXPECT_EQ(without.ao[i], with.ao[i]) << i;
    ++covered;
  }
  EXPECT_GT(covered, with.ao.size() / 8);
}

TEST(BakeTexture, AClosedRoomIsDarkThoughPrefilteredRaysSeeALittle) {
  Scene room = make_procedural("scene:cube?divisions=1");
  Mesh& mesh = room.meshes.at(0);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);  // the front sides look inwards
  BakeOptions options = into_texture(128);
  options.sides = BakeSides::front;
  const BakeResult result = bake(room, options);
  EXPECT_GT(result.statistics.dark_texels, 0u);
  EXPECT_EQ(result.statistics.enclosed_texels, 0u);
}

TEST(BakeTexture, MoreTexelsThanTheMachineHasMemoryForAreRefusedInBytes) {
  TextureLayout layout;
  layout.corners = {{V2f(0, 0), V2f(1, 0), V2f(0, 1)}, {V2f(0, 0), V2f(1, 0), V2f(1, 1)}};
  BakeOptions options = into_texture(16384);
  const double bytes = texture_bake_bytes(layout, options, 0);
  EXPECT_NEAR(bytes / (16384.0 * 16384), 0.5 * 130 + 24, 1) << "half covered by each mesh";
  EXPECT_NO_THROW(check_texture_memory(layout, options, 0, bytes));
  EXPECT_NO_THROW(check_texture_memory(layout, options, 0, 0)) << "not known";
  try {
    check_texture_memory(layout, options, 0, 8e9);
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "--size 16384: the texture takes 24 GB while it is baked, and this machine has 8 GB; "
              "make it smaller");
  }
  options.light = true;
  EXPECT_GT(texture_bake_bytes(layout, options, 2), bytes);
}

TEST(BakeTexture, OfSeveralPosesTheFirstOneIsBaked) {
  Mesh mesh = square_mesh(1, 0, 1, 0);
  mesh.sources = {{0, 0, 0, static_cast<std::uint32_t>(mesh.positions.size()), {}}};
  Scene scene = scene_of(mesh);
  Mesh pose = mesh;  // of the same primitive, with a triangle that has no area any more
  pose.positions[pose.indices[0]] = pose.positions[pose.indices[1]];
  place(scene, pose, M44f().setTranslation(V3f(5, 0, 0)));
  BakeOptions options = into_texture(16);
  options.estimator = Estimator::exact;
  const BakeResult result = bake(scene, options);
  EXPECT_FALSE(result.texture.layout.corners.at(0).empty());
  EXPECT_TRUE(result.texture.layout.corners.at(1).empty());
  EXPECT_EQ(*std::min_element(result.texture.ao.begin(), result.texture.ao.end()), 1.0f);
}

}  // namespace
}  // namespace dapple
