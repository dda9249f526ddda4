// Mip levels of cut-out textures whose alphas are interpolated, and of clamped ones.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/opacity/opacity_mip_levels.hpp"
#include "bvh/opacity/prefilter.hpp"
#include "bvh/opacity/texture_integrals.hpp"
#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// The share of a texture's area that is opaque where alphas are interpolated before they are cut.
double interpolated_mean(const Texture& texture, float cutoff) {
  constexpr int kSide = 640;
  const OpacityMipLevels alphas(texture, 1, -1);
  int opaque = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      opaque += alphas.mean(V2f(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) / kSide,
                            1) >= cutoff;
  return opaque / double{kSide * kSide};
}

TEST(OpacityMipLevels, CutOutsAreInterpolatedBeforeTheyAreThresholded) {
  Texture stripes;
  stripes.width = stripes.height = 16;
  for (int i = 0; i < 256; ++i) stripes.alpha.push_back(i % 8 < 2 ? 255 : 0);
  Texture noise = stripes;
  std::mt19937 random(9);
  for (std::uint8_t& alpha : noise.alpha) alpha = static_cast<std::uint8_t>(random() % 256);
  for (const Texture& texture : {stripes, noise})
    for (const float cutoff : {0.1f, 0.3f, 0.5f, 0.8f})
      EXPECT_NEAR(OpacityMipLevels(texture, 1, cutoff).mean({0.5f, 0.5f}, 1e6f),
                  interpolated_mean(texture, cutoff), 0.04)
          << cutoff;
}

// Blades of two texels in eight: above a cutoff c they are 1 + 2 (1 - c) wide.
TEST(OpacityMipLevels, EdgesOfBinaryAlphasLieWhereTheCutoffSays) {
  for (const bool across : {false, true}) {
    Texture blades;
    blades.width = blades.height = 16;
    for (int i = 0; i < 256; ++i) blades.alpha.push_back((across ? i / 16 : i) % 8 < 2 ? 255 : 0);
    for (const float cutoff : {0.1f, 0.25f, 0.5f, 0.9f})
      EXPECT_NEAR(OpacityMipLevels(blades, 1, cutoff).mean({0.5f, 0.5f}, 1e6f),
                  (1 + 2 * (1 - cutoff)) / 8, 0.003)
          << cutoff;
  }
}

TEST(OpacityMipLevels, CoordinatesBeyondTheBorderOfAClampedTextureSeeItsTexels) {
  const std::array<V2f, 3> outside{V2f(-1, 0.5f), V2f(2, 0), V2f(2, 1)};
  EXPECT_TRUE(is_beyond_border(outside, Wrap::clamp, Wrap::repeat));
  EXPECT_FALSE(is_beyond_border(outside, Wrap::repeat, Wrap::clamp));
  EXPECT_FALSE(is_beyond_border({V2f(0, 0), V2f(1, 0), V2f(1.001f, 1)}, Wrap::clamp, Wrap::clamp));
  // Opaque but for a border of one texel; a card on whose middle it lies.
  Texture decal;
  decal.width = decal.height = 64;
  decal.wrap_s = decal.wrap_t = Wrap::clamp;
  for (int i = 0; i < 64 * 64; ++i)
    decal.alpha.push_back(i % 64 % 63 == 0 || i / 64 % 63 == 0 ? 0 : 255);
  Scene scene;
  scene.textures.push_back(decal);
  scene.materials.emplace_back().alpha_mode = AlphaMode::mask;
  scene.materials[0].alpha_texture = 0;
  Mesh& card = scene.meshes.emplace_back();
  card.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  card.uvs = {{-1, -1}, {2, -1}, {2, 2}, {-1, 2}};
  card.indices = {0, 1, 2, 0, 2, 3};
  card.materials = {0, 0};
  scene.instances.emplace_back();
  const TexturedTriangle triangle = textured_triangle(scene, card, 0, true);
  EXPECT_EQ(unpack_textured(triangle).texel_size, 0) << "rays read the texture itself";
  const std::array all = {triangle};
  EXPECT_EQ(TextureIntegrals(scene, all).of(triangle).mean(0.05f, 0.05f, 1), 0) << "in a corner";
  BuiltObject built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]);
  prefilter(built, TextureIntegrals(scene, built.object.textured));
  // A cell of the map, a sixteenth of the card, is seen or not by its middle.
  EXPECT_NEAR(built.object.opacity.axes.z, std::pow(62.0 / 64 / 3, 2), 0.05);
}

}  // namespace
}  // namespace dapple
