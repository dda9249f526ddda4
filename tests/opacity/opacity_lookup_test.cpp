// Compares kernels/opacity/opacity_lookup.clh on the device with glTF's definition in double
// precision: bilinear and nearest lookups, all wrap modes, small and large coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bvh/storage/textured_triangle.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/geometry.h"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

constexpr float kFar = 4096.0f;  // the device subtracts whole tiles from larger coordinates first

Texture noise_texture(Wrap wrap_s, Wrap wrap_t, bool nearest) {
  Texture texture;
  texture.width = 13;
  texture.height = 6;
  texture.wrap_s = wrap_s;
  texture.wrap_t = wrap_t;
  texture.nearest = nearest;
  std::mt19937 random(1);
  for (int i = 0; i < 13 * 6; ++i)
    texture.alpha.push_back(static_cast<std::uint8_t>(random() % 256));
  return texture;
}

/// Index of the texel at `cell`, as glTF's wrap modes define it.
std::int64_t wrapped(std::int64_t cell, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp<std::int64_t>(cell, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size;
  const std::int64_t in = ((cell % period) + period) % period;
  return in < size ? in : 2 * size - 1 - in;
}

double texel(const Texture& t, double x, double y) {
  const auto column = wrapped(static_cast<std::int64_t>(x), t.width, t.wrap_s);
  const auto row = wrapped(static_cast<std::int64_t>(y), t.height, t.wrap_t);
  return t.alpha[static_cast<std::size_t>(row * t.width + column)] / 255.0;
}

double look_up(const Texture& t, const V2f& uv) {
  const double x = static_cast<double>(uv.x) * t.width, y = static_cast<double>(uv.y) * t.height;
  if (t.nearest) return texel(t, std::floor(x), std::floor(y));
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const double fx = x - 0.5 - left, fy = y - 0.5 - top;
  return (texel(t, left, top) * (1 - fx) + texel(t, left + 1, top) * fx) * (1 - fy) +
         (texel(t, left, top + 1) * (1 - fx) + texel(t, left + 1, top + 1) * fx) * fy;
}

/// The rounding error of the float `uv`, in texels.
double rounding(float uv, std::uint32_t size) {
  const double held = std::fabs(uv) < kFar ? std::fabs(uv) : 2.0;
  return 2.5e-7 * (held * size + 1);
}

/// Whether rounding could move a nearest lookup to another texel.
bool on_a_border(float uv, std::uint32_t size) {
  const double at = static_cast<double>(uv) * size;
  return std::fabs(at - std::round(at)) < rounding(uv, size);
}

std::vector<V2f> coordinates() {
  std::vector<V2f> uvs{{0, 0}, {1, 1}, {0.5f, 0.5f}, {-0.0f, -1}, {-1e-9f, 2}, {1, -3}};
  std::mt19937 random(2);
  for (const float reach : {1.0f, 3.0f, 50.0f, 4000.0f, 1e6f, 1e9f}) {
    std::uniform_real_distribution<float> at(-reach, reach);
    for (int i = 0; i < 300; ++i) {
      const float u = at(random), v = at(random);
      uvs.push_back({u, v});
      uvs.push_back({u, v / reach});
      uvs.push_back({u / reach, v});
    }
  }
  return uvs;
}

struct Textures {
  std::vector<Texture> textures;
  std::vector<TextureRecord> records;
  std::vector<uchar> texels;
};

/// Textures of all pairs of wrap modes, bilinear and nearest, packed as the uploader packs them.
Textures every_kind() {
  Textures all;
  for (const Wrap s : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
    for (const Wrap t : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
      for (const bool nearest : {false, true}) {
        all.textures.push_back(noise_texture(s, t, nearest));
        all.texels.resize((all.texels.size() + 15) / 16 * 16);
        all.records.push_back(
            {static_cast<uint>(all.texels.size() / 16), 13, 6,
             static_cast<uint>(s) | static_cast<uint>(t) << 2 | (nearest ? 16u : 0u)});
        const auto& alpha = all.textures.back().alpha;
        all.texels.insert(all.texels.end(), alpha.begin(), alpha.end());
      }
    }
  }
  return all;
}

TEST(OpacityLookup, TheDeviceLooksUpAsGltfDefinesNearAndFar) {
  const Textures all = every_kind();
  const auto uvs = coordinates();
  const Buffer records = upload(all.records), texels = upload(all.texels), where = upload(uvs);
  const Buffer results = device().allocate(uvs.size() * sizeof(float));
  for (std::size_t i = 0; i < all.textures.size(); ++i) {
    const Texture& texture = all.textures[i];
    SCOPED_TRACE("wraps " + std::to_string(static_cast<int>(texture.wrap_s)) + " " +
                 std::to_string(static_cast<int>(texture.wrap_t)) +
                 (texture.nearest ? " nearest" : " bilinear"));
    run("lookup", "look_up", uvs.size(),
        {records, texels, where, results, static_cast<uint>(i), static_cast<uint>(uvs.size())});
    const auto alphas = download<float>(results, uvs.size());
    int wrong = 0;
    for (std::size_t k = 0; k < uvs.size(); ++k) {
      const double across = rounding(uvs[k].x, 13), down = rounding(uvs[k].y, 6);
      if (texture.nearest && (on_a_border(uvs[k].x, 13) || on_a_border(uvs[k].y, 6))) continue;
      // Neighbouring texels differ by at most 1, so a bilinear lookup changes by at most 1 a texel.
      const double tolerance = texture.nearest ? 1e-6 : 1e-6 + across + down;
      const double expected = look_up(texture, uvs[k]);
      if (std::fabs(alphas[k] - expected) <= tolerance) continue;
      if (++wrong <= 3) ADD_FAILURE() << uvs[k] << " gives " << alphas[k] << ", not " << expected;
    }
    EXPECT_EQ(wrong, 0);
  }
}

TEST(OpacityLookup, ATrianglesOpacityIsFactorsTimesTextureThresholdedLast) {
  TexturedCorners corners;
  corners.uv = {V2f(0.1f, 0.2f), V2f(0.9f, 0.3f), V2f(0.4f, 0.8f)};
  corners.alpha = {1, 0.5f, 0.25f};
  std::vector<TexturedTriangle> triangles;
  for (const std::uint32_t t : {0u, 1u, 2u}) {
    corners.material = t % 2;
    corners.has_texture = t < 2;
    triangles.push_back(pack_textured(corners, Wrap::repeat, Wrap::repeat));
  }
  const Texture texture = noise_texture(Wrap::repeat, Wrap::repeat, false);
  const TextureRecord record{0, 13, 6, 0};
  const std::vector<MaterialRecord> materials{{record, 0.8f, -1, 0, 0, {}},
                                              {record, 0.8f, 0.3f, 0, 0, {}}};
  std::vector<V2f> barycentrics{{0, 0}, {1, 0}, {0, 1}};
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; i + j < 20; ++j) {
      barycentrics.push_back({static_cast<float>(i) / 20, static_cast<float>(j) / 20});
    }
  }
  const Buffer results = device().allocate(barycentrics.size() * sizeof(float));
  for (uint t = 0; t < 3; ++t) {
    run("lookup", "look_up_triangle", barycentrics.size(),
        {upload(triangles), upload(materials), upload(texture.alpha), upload(barycentrics), results,
         t, static_cast<uint>(barycentrics.size())});
    const auto opacities = download<float>(results, barycentrics.size());
    for (std::size_t i = 0; i < barycentrics.size(); ++i) {
      const float u = barycentrics[i].x, v = barycentrics[i].y, w = 1 - u - v;
      const V2f uv(0.1f * w + 0.9f * u + 0.4f * v, 0.2f * w + 0.3f * u + 0.8f * v);
      const double factor = 0.8 * (w + 0.5 * u + 0.25 * v);
      const double alpha = t == 2 ? factor : factor * look_up(texture, uv);
      if (t == 1 && std::fabs(alpha - 0.3) < 1e-5) continue;  // either side may be right
      // Interpolated coordinates are off by 2^-22 and a few roundings of 1; that times 13 texels.
      EXPECT_NEAR(opacities[i], t == 1 ? (alpha >= 0.3 ? 1.0 : 0.0) : alpha, 1e-5);
    }
  }
}

// glTF 2.0, section 3.9.4: an alpha greater than or equal to the cutoff is fully opaque. 0, 1/2 and
// 1 times the factor 1 are exact in float.
TEST(OpacityLookup, AnAlphaThatEqualsTheCutoffIsOpaque) {
  TexturedCorners plain;
  plain.alpha = {0.5f, 0.5f, 0.5f};
  TexturedCorners textured;
  textured.uv = {V2f(0.1f, 0.2f), V2f(0.9f, 0.3f), V2f(0.4f, 0.8f)};
  textured.alpha = {1, 1, 1};
  textured.has_texture = true;
  const std::vector<V2f> barycentrics(16, V2f(0.25f, 0.5f));
  const Buffer where = upload(barycentrics);
  const Buffer results = device().allocate(barycentrics.size() * sizeof(float));
  const auto opacity = [&](const TexturedCorners& corners, uchar alpha, float cutoff) {
    const std::vector<TexturedTriangle> triangles{
        pack_textured(corners, Wrap::repeat, Wrap::repeat)};
    const std::vector<MaterialRecord> materials{{{0, 4, 4, 0}, 1, cutoff, 0, 0, {}}};
    run("lookup", "look_up_triangle", barycentrics.size(),
        {upload(triangles), upload(materials), upload(std::vector<uchar>(16, alpha)), where,
         results, 0u, static_cast<uint>(barycentrics.size())});
    return download<float>(results, barycentrics.size())[0];
  };
  EXPECT_EQ(opacity(plain, 0, 0.5f), 1.0f);
  EXPECT_EQ(opacity(plain, 0, 0.501f), 0.0f);
  EXPECT_EQ(opacity(textured, 0, 0.0f), 1.0f);
  EXPECT_EQ(opacity(textured, 255, 1.0f), 1.0f);
  EXPECT_EQ(opacity(textured, 254, 1.0f), 0.0f);
}

}  // namespace
}  // namespace dapple
