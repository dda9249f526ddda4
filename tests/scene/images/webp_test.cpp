// WebP images give the pixels that a PNG with them gives.
#include <gtest/gtest.h>
#include <webp/encode.h>

#include <cmath>

#include "scene/images/color.hpp"
#include "scene/images/image.hpp"
#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

constexpr int kWidth = 19, kHeight = 7;

/// RGBA. libwebp writes black where alpha is 0.
Bytes leaf_pixels() {
  Bytes pixels;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const auto alpha = static_cast<std::uint8_t>(i * 37 % 256);
    const auto red = static_cast<std::uint8_t>(alpha == 0 ? 0 : 3 * i % 256);
    pixels.insert(pixels.end(), {red, static_cast<std::uint8_t>(alpha == 0 ? 0 : 200),
                                 static_cast<std::uint8_t>(alpha == 0 ? 0 : i), alpha});
  }
  return pixels;
}

Bytes taken(std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, data + size);
  WebPFree(data);
  return bytes;
}

Bytes lossless(const Bytes& rgba, int width, int height) {
  std::uint8_t* data = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &data);
  return taken(data, size);
}

TEST(Webp, LosslessImagesAreThoseOfAPng) {
  const Bytes rgba = leaf_pixels();
  const ColorImage png = decode_color(png::encode(kWidth, kHeight, 8, 6, rgba), "png");
  const ColorImage webp = decode_color(lossless(rgba, kWidth, kHeight), "webp");
  EXPECT_EQ(webp.width, png.width);
  EXPECT_EQ(webp.height, png.height);
  EXPECT_EQ(webp.rgb, png.rgb);
  EXPECT_EQ(webp.alpha, png.alpha);
  EXPECT_EQ(decode_alpha(lossless(rgba, kWidth, kHeight), "webp").alpha, png.alpha);
}

// Of one colour, which lossy compression keeps to a step or two; 0.01 is four steps at that level.
TEST(Webp, LossyImagesWithoutAlphaAreOpaque) {
  const Bytes rgb(3 * 32 * 32, 150);
  std::uint8_t* data = nullptr;
  const std::size_t size = WebPEncodeRGB(rgb.data(), 32, 32, 3 * 32, 90, &data);
  const Bytes file = taken(data, size);
  EXPECT_EQ(decode_alpha(file, "webp").alpha, Bytes(32 * 32, 255));
  const Imath::V3f mean = mean_linear_color(file, "webp");
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], linear_from_srgb(150 / 255.0), 0.01);
}

TEST(Webp, DamagedAndCutImagesAreNamed) {
  const Bytes whole = lossless(leaf_pixels(), kWidth, kHeight);
  const auto error = [](const Bytes& bytes) {
    return input_error([&] { decode_color(bytes, "leaf.webp"); });
  };
  for (const std::size_t size : {16u, 29u})
    expect_says(error(Bytes(whole.begin(), whole.begin() + size)),
                "leaf.webp: is corrupt (its WebP");
  expect_says(error(Bytes(whole.begin(), whole.end() - 20)),
              "leaf.webp: is corrupt (its WebP data)");
}

/// The header of a VP8X file of 19 x 7 pixels whose flags say that it is an animation.
TEST(Webp, AnimationsAreRefused) {
  Bytes file = {'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                'X', 10,  0,   0,   0,  2, 0, 0, 0,   18,  0,   0,   6,   0,   0};
  expect_says(input_error([&] { decode_color(file, "leaf.webp"); }), "leaf.webp: is an animation");
}

/// A triangle whose texture has the alphas `png` as its source and `webp` by the extension.
GltfBuilder with_both(const Bytes& png_alphas, const Bytes& webp) {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  builder.doc["materials"] = {
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const int source =
      builder.add("images", {{"bufferView", builder.add_view(png::with_alpha(2, 1, png_alphas))},
                             {"mimeType", "image/png"}});
  const int other =
      builder.add("images", {{"bufferView", builder.add_view(webp.empty() ? Bytes{0} : webp)},
                             {"mimeType", "image/webp"}});
  builder.add("textures",
              {{"source", source}, {"extensions", {{"EXT_texture_webp", {{"source", other}}}}}});
  builder.doc["extensionsUsed"] = {"EXT_texture_webp"};
  return builder;
}

TEST(Webp, TheExtensionStandsInForTheSource) {
  const Bytes webp = lossless({9, 9, 9, 40, 9, 9, 9, 90}, 2, 1);
  GltfBuilder builder = with_both({10, 20}, webp);
  EXPECT_EQ(builder.load().textures.at(0).alpha, (Bytes{40, 90}));
  builder.doc["textures"][0].erase("source");
  builder.doc["extensionsRequired"] = {"EXT_texture_webp"};
  EXPECT_EQ(builder.load().textures.at(0).alpha, (Bytes{40, 90}));
  builder.doc["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 8;
  expect_says(error_of(builder), "texture 0 names image 8, but there are 2");
}

TEST(Webp, WithoutItsFileTheSourceIsRead) {
  GltfBuilder builder = with_both({10, 20}, {});
  builder.doc["images"][1] = {{"uri", "gone.webp"}};
  EXPECT_EQ(builder.load().textures.at(0).alpha, (Bytes{10, 20}));
  builder.doc["textures"][0]["extensions"]["EXT_texture_webp"] = json::object();
  EXPECT_EQ(builder.load().textures.at(0).alpha, (Bytes{10, 20}));
}

}  // namespace
}  // namespace dapple::test
