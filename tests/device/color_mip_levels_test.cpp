// Mip levels of colour textures: which texels count, and the colours of those that are not seen.
#include "device/upload/color_mip_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace dapple {
namespace {

constexpr TexelWeights kByAlpha{TexelWeights::Kind::by_alpha, 0};

TEST(ColorMipLevels, UnseenTexelsOfACutOutDoNotColourMeans) {
  ColorTexture texture;
  texture.width = texture.height = 2;
  texture.rgb = {255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  texture.alpha = {255, 0, 0, 0};
  const std::vector<ColorLevel> levels = color_mip_levels(texture, kByAlpha);
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_NEAR(levels[0].color[0].x, 1, 1e-3);
  texture.alpha = {};
  EXPECT_NEAR(color_mip_levels(texture, kByAlpha)[0].color[0].x, 0.25, 1e-6);
}

TEST(ColorMipLevels, UnseenTexelsHaveTheColourOfWhatIsSeenAroundThem) {
  ColorTexture texture;
  texture.width = 64;
  texture.height = 32;
  for (std::size_t i = 0; i < 64 * 32; ++i) {
    const bool seen = i % 64 < 3 && i / 64 < 5;
    const int red = seen ? 255 : 0;
    texture.rgb.insert(texture.rgb.end(), {static_cast<std::uint8_t>(red), 0, 255});
    texture.alpha.push_back(seen ? 255 : 0);
  }
  const std::vector<ColorLevel> levels = color_mip_levels(texture, kByAlpha);
  ASSERT_EQ(levels.size(), 6u);
  for (const ColorLevel& level : levels)
    for (const V3f& color : level.color) EXPECT_NEAR(color.x, 1, 1e-6) << level.width;
  std::fill(texture.alpha.begin(), texture.alpha.end(), std::uint8_t{0});
  EXPECT_NEAR(color_mip_levels(texture, kByAlpha).back().color[0].x, 15.0 / (64 * 32), 1e-6);
}

TEST(ColorMipLevels, UnseenTexelsBesideALeafHaveItsColourNotThatOfAnother) {
  ColorTexture atlas;
  atlas.width = 64;
  atlas.height = 4;
  for (std::size_t i = 0; i < 64 * 4; ++i) {  // red up to 31, green from 48 on
    const bool red = i % 64 < 32, green = i % 64 >= 48;
    atlas.rgb.insert(atlas.rgb.end(), {static_cast<std::uint8_t>(red ? 255 : 0),
                                       static_cast<std::uint8_t>(green ? 255 : 0), 0});
    atlas.alpha.push_back(red || green ? 255 : 0);
  }
  const ColorLevel first = color_mip_levels(atlas, kByAlpha).at(0);
  EXPECT_EQ(color_of_unseen(atlas, kByAlpha, first, 32, 0), V3f(1, 0, 0));
  EXPECT_EQ(color_of_unseen(atlas, kByAlpha, first, 47, 0), V3f(0, 1, 0));
  EXPECT_EQ(first.color[16], V3f(1, 0, 0)) << "texels 32 and 33";
}

TEST(ColorMipLevels, TexelsCountAsTheMaterialSeesThem) {
  ColorTexture texture;
  texture.width = 2;
  texture.height = 1;
  texture.rgb = {255, 0, 0, 0, 0, 255};
  texture.alpha = {120, 255};
  Material material;
  material.alpha_texture = 0;
  const auto red = [&] { return color_mip_levels(texture, texel_weights(material))[0].color[0].x; };
  EXPECT_NEAR(red(), 0.5, 1e-4) << "opaque";
  material.alpha_mode = AlphaMode::blend;
  EXPECT_NEAR(red(), 120.0 / 375, 1e-4);
  material.alpha_mode = AlphaMode::mask;
  EXPECT_NEAR(red(), 0, 1e-3);
  material.alpha_cutoff = 0.25f;
  EXPECT_NEAR(red(), 0.5, 1e-4);
  material.alpha = 0.5f;
  EXPECT_NEAR(red(), 0, 1e-3);
  material.alpha_texture = -1;
  EXPECT_NEAR(red(), 0.5, 1e-4) << "as --opacity makes it";
}

TEST(ColorMipLevels, AllTexelsOfAnOddSizeCountTheSame) {
  for (const std::uint32_t side : {3u, 5u, 9u, 100u, 101u}) {
    ColorTexture texture;
    texture.width = side;
    texture.height = 2;
    for (std::uint32_t i = 0; i < 2 * side; ++i)
      texture.rgb.insert(texture.rgb.end(), 3, i % side == side - 1 ? 255 : 0);
    for (const ColorLevel& level : color_mip_levels(texture, {})) {
      double sum = 0;
      for (const V3f& color : level.color) sum += double{color.x};
      EXPECT_NEAR(sum / static_cast<double>(level.color.size()), 1.0 / side, 1e-5) << side;
    }
  }
}

}  // namespace
}  // namespace dapple
