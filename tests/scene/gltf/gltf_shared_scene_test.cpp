// The glTF reader on scenes that other programs wrote. These scenes are not part of the repository;
// without them the tests are skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "dapple/scene.hpp"

namespace dapple::test {
namespace {

std::string shared_scene(const std::string& name) {
  const std::string path = std::string(DAPPLE_SHARED_SCENES) + "/" + name;
  return std::filesystem::exists(path) ? path : std::string();
}

std::size_t triangles_of(const Scene& scene, const std::string& material) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) {
    for (const std::uint32_t m : scene.meshes[instance.mesh].materials) {
      if (scene.materials[m].name == material) ++count;
    }
  }
  return count;
}

Box3f world_bounds(const Scene& scene) {
  Box3f bounds;
  for (const Instance& instance : scene.instances) {
    for (const V3f& p : scene.meshes[instance.mesh].positions) {
      bounds.extendBy(p * instance.to_world);
    }
  }
  return bounds;
}

TEST(GltfSharedScene, TheSaplingHasItsTrianglesAndBounds) {
  const std::string path = shared_scene("sapling_100k.glb");
  if (path.empty()) GTEST_SKIP() << "sapling_100k.glb is not here";
  const Scene scene = load_gltf(path);
  EXPECT_EQ(triangles_of(scene, "leaf"), 63420u);
  EXPECT_EQ(triangles_of(scene, "bark"), 95084u - 63420u);
  // The file's accessors state these bounds in min and max; its two nodes have no transforms.
  const Box3f bounds = world_bounds(scene);
  EXPECT_EQ(bounds.min, V3f(-5.0008697509765625f, 0, -5.2450714111328125f));
  EXPECT_EQ(bounds.max, V3f(5.077890396118164f, 14.557462692260742f, 6.085202217102051f));
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfSharedScene, ThePineLoadsDespiteItsAbsentNormalMap) {
  const std::string path = shared_scene("smallpine/scene.gltf");
  if (path.empty()) GTEST_SKIP() << "smallpine/scene.gltf is not here";
  const Scene scene = load_gltf(path);
  EXPECT_EQ(triangles_of(scene, "M_TreeAtlas"), 1442u);
  EXPECT_EQ(triangles_of(scene, "Trunk"), 1650u - 1442u);
  ASSERT_EQ(scene.textures.size(), 1u) << "only the atlas carries an alpha that counts";
  EXPECT_EQ(scene.textures[0].width, 2048u);
  EXPECT_EQ(scene.textures[0].height, 2048u);
  const Material& needles = scene.materials.at(1);
  EXPECT_EQ(needles.name, "M_TreeAtlas");
  EXPECT_EQ(needles.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(needles.alpha_texture, 0);
}

/// Alpha of the nearest texel, in [0,1], with repeated texture coordinates. Precise enough for a
/// mean.
double alpha_at(const Texture& texture, V2f uv) {
  const auto texel = [](float coordinate, std::uint32_t size) {
    const float fraction = coordinate - std::floor(coordinate);
    return std::min(static_cast<std::uint32_t>(fraction * static_cast<float>(size)), size - 1);
  };
  const std::size_t at =
      std::size_t{texel(uv.y, texture.height)} * texture.width + texel(uv.x, texture.width);
  return texture.alpha[at] / 255.0;
}

/// Mean alpha of a triangle: the texture is looked up at the centres of 16^2 equal parts.
double mean_alpha(const Texture& texture, V2f a, V2f b, V2f c) {
  constexpr int kParts = 16;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; j < 2 * (kParts - i) - 1; ++j) {
      const bool down = j % 2 != 0;
      const float u = (static_cast<float>(i) + (down ? 2.0f : 1.0f) / 3.0f) / kParts;
      const float v = (static_cast<float>(j / 2) + (down ? 2.0f : 1.0f) / 3.0f) / kParts;
      sum += alpha_at(texture, a + (b - a) * u + (c - a) * v);
    }
  }
  return sum / (kParts * kParts);
}

TEST(GltfSharedScene, ThePinesCardsHaveAMeanAlphaOfFourTenths) {
  const std::string path = shared_scene("smallpine/scene.gltf");
  if (path.empty()) GTEST_SKIP() << "smallpine/scene.gltf is not here";
  const Scene scene = load_gltf(path);
  double sum = 0;
  double triangles = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.uvs.empty()) continue;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const std::uint32_t* corner = &mesh.indices[3 * t];
      sum += mean_alpha(scene.textures[0], mesh.uvs[corner[0]], mesh.uvs[corner[1]],
                        mesh.uvs[corner[2]]);
      ++triangles;
    }
  }
  // The scene's README says "about 0.40"; with v upside down it would be 0.22.
  EXPECT_NEAR(sum / triangles, 0.40, 0.02);
}

TEST(GltfSharedScene, ThePineStandsUpright) {
  const std::string path = shared_scene("smallpine/scene.gltf");
  if (path.empty()) GTEST_SKIP() << "smallpine/scene.gltf is not here";
  // The node matrices turn the accessors' Z axis (0.017 to 75.014) into Y. Their scales of 0.01 and
  // 100 cancel each other.
  const Box3f bounds = world_bounds(load_gltf(path));
  EXPECT_NEAR(bounds.min.y, 0.0169f, 1e-3f);
  EXPECT_NEAR(bounds.max.y, 75.0142f, 1e-3f);
}

}  // namespace
}  // namespace dapple::test
