// Triangles whose texture is opaque all over: what is found against all texels that look-ups read,
// and the opacity of such triangles.
#include "bvh/opacity/opaque_texels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// A texture of `alpha`, and a masked material with it.
Scene textured(std::uint32_t width, std::uint32_t height, std::uint8_t alpha = 255) {
  Scene scene;
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.alpha.assign(std::size_t{width} * height, alpha);
  scene.textures.push_back(std::move(texture));
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  return scene;
}

Mesh triangle(V2f a, V2f b, V2f c) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2};
  mesh.materials = {0};
  mesh.uvs = {a, b, c};
  return mesh;
}

std::size_t wrapped(int i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp) return static_cast<std::size_t>(std::min(std::max(i, 0), size - 1));
  const int period = wrap == Wrap::mirror ? 2 * size : size;
  const int r = (i % period + period) % period;
  return static_cast<std::size_t>(r < size ? r : period - 1 - r);
}

/// All texels of bilinear look-ups in the rectangle around the triangle, one by one.
bool is_opaque(const Texture& texture, const Mesh& mesh) {
  int first[2], last[2];
  const int size[2] = {static_cast<int>(texture.width), static_cast<int>(texture.height)};
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({mesh.uvs[0][axis], mesh.uvs[1][axis], mesh.uvs[2][axis]});
    first[axis] = static_cast<int>(std::floor(double{low} * size[axis] - 0.5));
    last[axis] = static_cast<int>(std::floor(double{high} * size[axis] - 0.5)) + 1;
  }
  for (int y = first[1]; y <= last[1]; ++y)
    for (int x = first[0]; x <= last[0]; ++x)
      if (texture.alpha[wrapped(y, size[1], texture.wrap_t) * texture.width +
                        wrapped(x, size[0], texture.wrap_s)] < 128)
        return false;
  return true;
}

TEST(OpaqueTexels, AreFoundWhereAllTexelsOfTheRectangleAreOpaque) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(-2.5f, 2.5f), size(0, 0.6f);
  int opaque = 0, others = 0;
  for (const Wrap wrap_s : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
    for (const Wrap wrap_t : {Wrap::repeat, Wrap::mirror}) {
      Scene scene = textured(24, 17);
      Texture& texture = scene.textures[0];
      texture.wrap_s = wrap_s;
      texture.wrap_t = wrap_t;
      for (int i = 0; i < 6; ++i) texture.alpha[random() % texture.alpha.size()] = 100;
      const OpaqueTexels texels(scene);
      for (int i = 0; i < 2000; ++i) {
        const V2f at(anywhere(random), anywhere(random));
        const auto corner = [&] { return at + V2f(size(random), size(random)) * size(random); };
        const Mesh mesh = triangle(corner(), corner(), corner());
        const bool expected = is_opaque(texture, mesh);
        ASSERT_EQ(texels.cover(mesh, 0), expected)
            << static_cast<int>(wrap_s) << static_cast<int>(wrap_t) << mesh.uvs[0] << mesh.uvs[1]
            << mesh.uvs[2];
        ++(expected ? opaque : others);
      }
    }
  }
  EXPECT_GT(opaque, 3000);
  EXPECT_GT(others, 2000);
}

TEST(OpaqueTexels, OfLargeTexturesSquaresAreLookedAt) {
  Scene scene = textured(2048, 1024);
  scene.textures[0].alpha[500 * 2048 + 1001] = 0;
  const OpaqueTexels texels(scene);
  const auto around = [&](float x, float y, float half) {
    const V2f at(x / 2048, y / 1024), step(half / 2048, half / 1024);
    return texels.cover(triangle(at - step, at + step, {at.x - step.x, at.y + step.y}), 0);
  };
  EXPECT_FALSE(around(1001.5f, 500.5f, 0.1f));
  EXPECT_FALSE(around(1100, 600, 150));
  EXPECT_TRUE(around(1020, 500.5f, 10));
  EXPECT_TRUE(around(1001.5f, 520, 10));
}

TEST(OpaqueTexels, CoordinatesBeyondAllTexturesAreNotLookedUp) {
  const Scene scene = textured(2, 2);
  const OpaqueTexels texels(scene);
  EXPECT_TRUE(texels.cover(triangle({0, 0}, {1e6f, 0}, {0, -1e6f}), 0));
  EXPECT_FALSE(texels.cover(triangle({0, 0}, {1e30f, 0}, {0, 1}), 0));
  EXPECT_FALSE(texels.cover(triangle({0, 0}, {NAN, 0}, {0, 1}), 0));
}

class OpacityOfTexels : public testing::Test {
 protected:
  [[nodiscard]] std::optional<float> opacity() const {
    return uniform_opacity(scene_, OpaqueTexels(scene_), mesh_, 0);
  }
  Material& material() { return scene_.materials[0]; }
  std::uint8_t& texel() { return scene_.textures[0].alpha[0]; }

  Scene scene_ = textured(4, 4);
  Mesh mesh_ = triangle({0.1f, 0.1f}, {0.4f, 0.1f}, {0.1f, 0.4f});
};

TEST_F(OpacityOfTexels, OfAMaskedMaterialTheyReachTheCutoff) {
  EXPECT_EQ(opacity(), 1.0f);
  texel() = 128;  // the cutoff is 0.5
  EXPECT_EQ(opacity(), 1.0f);
  texel() = 127;
  EXPECT_FALSE(opacity());
  material().alpha_cutoff = 0.25f;
  EXPECT_EQ(opacity(), 1.0f);
  material().alpha = 0.5f;
  EXPECT_FALSE(opacity());
  material().alpha_cutoff = 0;
  texel() = 0;
  EXPECT_EQ(opacity(), 1.0f);
  material().alpha_cutoff = 2;
  texel() = 255;
  EXPECT_FALSE(opacity());
}

TEST_F(OpacityOfTexels, OfABlendedMaterialTheyAreOne) {
  material().alpha_mode = AlphaMode::blend;
  EXPECT_EQ(opacity(), 1.0f);
  material().alpha = 0.75f;
  EXPECT_EQ(opacity(), 0.75f);
  texel() = 254;
  EXPECT_FALSE(opacity());
}

TEST_F(OpacityOfTexels, AlphasOfVerticesMayCutOutWhatTheyDoNot) {
  material().uses_vertex_alpha = true;
  mesh_.vertex_alpha = {1, 1, 1};
  EXPECT_EQ(opacity(), 1.0f);
  mesh_.vertex_alpha = {0.9f, 0.9f, 0.9f};
  EXPECT_FALSE(opacity());
  material().alpha_mode = AlphaMode::blend;
  EXPECT_EQ(opacity(), 0.9f);
  mesh_.vertex_alpha = {0.9f, 0.9f, 0.8f};
  EXPECT_FALSE(opacity());
}

}  // namespace
}  // namespace dapple
