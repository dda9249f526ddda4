// Mesh lights as the kernels sample them: areas that shine, of lamps that share a mesh or a
// texture.
#include "device/upload/light_upload.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {
namespace {

constexpr std::size_t kLamps = 200;
constexpr std::uint32_t kSize = 1024;

/// Lamps of 2 m^2, half of which a mask cuts out: those with even numbers are instances of one
/// mesh, the others have a mesh each. All have one texture.
Scene masked_lamps() {
  Scene scene;
  Texture texture{"mask", kSize, kSize, std::vector<std::uint8_t>(kSize * kSize, 255)};
  std::fill_n(texture.alpha.begin(), kSize * kSize / 2, std::uint8_t{0});
  scene.textures.push_back(texture);
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  Mesh square;
  square.positions = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  square.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.indices = {0, 1, 2, 0, 2, 3};
  square.materials = {0, 0};
  scene.meshes.push_back(square);
  for (std::size_t i = 0; i < kLamps; ++i) {
    if (i % 2 == 1) scene.meshes.push_back(square);
    Instance instance;
    instance.mesh = i % 2 == 1 ? static_cast<std::uint32_t>(scene.meshes.size() - 1) : 0;
    instance.to_world.setTranslation(V3f(static_cast<float>(i), 0, 0));
    instance.light = static_cast<int>(i);
    scene.instances.push_back(instance);
    Light light;
    light.kind = LightKind::mesh;
    scene.lights.push_back(light);
  }
  return scene;
}

TEST(LightUpload, LampsOfOneTextureShareItsMipLevels) {
  const Scene scene = masked_lamps();
  std::vector<LightRecord> records;
  std::vector<EmitterTriangle> emitters;
  const std::clock_t start = std::clock();
  pack_lights(scene, records, emitters);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_EQ(records.size(), kLamps);
  for (const LightRecord& record : records) EXPECT_NEAR(record.area, 1, 0.03);
  for (const std::size_t lamp : {7, 8})  // of a mesh of its own, of the shared one
    EXPECT_NEAR(emitters[records[lamp].first_triangle].vertex[0], static_cast<float>(lamp) + 1, 1)
        << lamp;
  EXPECT_LT(seconds, 10) << "levels of each lamp's own take a minute";
}

}  // namespace
}  // namespace dapple
