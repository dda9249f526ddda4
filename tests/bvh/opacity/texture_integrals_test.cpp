// Mip levels that objects share: each is made once, and stays as long as there is room or as it is
// used.
#include "bvh/opacity/texture_integrals.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace dapple {
namespace {

/// A scene of four textures of 16 by 16 texels.
Scene four_textures() {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    Texture texture;
    texture.width = texture.height = 16;
    texture.alpha.assign(256, static_cast<std::uint8_t>(50 * i));
    scene.textures.push_back(texture);
  }
  return scene;
}

/// Of four levels and the texture.
constexpr std::size_t kBytes = (256 + 64 + 16 + 4 + 1) * sizeof(float);

OpacityTexture blended(int texture) { return {texture, 1, -1}; }

TEST(SharedMipLevels, AreMadeOnceForAllThreads) {
  const Scene scene = four_textures();
  SharedMipLevels shared(scene);
  std::vector<std::shared_ptr<const OpacityMipLevels>> found(400);
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = shared.of(blended(static_cast<int>(i % 4))); });
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i], found[i % 4]);
    EXPECT_FLOAT_EQ(found[i]->levels().back().opacity[0], 50.0f * static_cast<float>(i % 4) / 255);
  }
  EXPECT_NE(found[0], found[1]);
}

TEST(SharedMipLevels, OfOneTextureDifferWithFactorAndCutoff) {
  const Scene scene = four_textures();
  SharedMipLevels shared(scene);
  EXPECT_EQ(shared.of({3, 1, 0.5f}), shared.of({3, 1, 0.5f}));
  EXPECT_EQ(shared.of({3, 1, 0.5f})->levels()[0].opacity[0], 1) << "its alpha is 150";
  EXPECT_EQ(shared.of({3, 1, 0.6f})->levels()[0].opacity[0], 0);
  EXPECT_EQ(shared.of({3, 0.75f, 0.5f})->levels()[0].opacity[0], 0);
}

TEST(SharedMipLevels, StayWhileThereIsRoomOrTheyAreUsed) {
  const Scene scene = four_textures();
  SharedMipLevels shared(scene, 2 * kBytes);
  const auto used = shared.of(blended(0));
  std::weak_ptr<const OpacityMipLevels> others[3];
  for (int i = 0; i < 3; ++i) others[i] = shared.of(blended(i + 1));
  EXPECT_EQ(shared.of(blended(0)), used);
  EXPECT_TRUE(others[0].expired()) << "two were made since";
  EXPECT_FALSE(others[1].expired());
  EXPECT_FALSE(others[2].expired());
  EXPECT_FLOAT_EQ(shared.of(blended(1))->levels()[0].opacity[0], 50.0f / 255) << "made again";
}

}  // namespace
}  // namespace dapple
