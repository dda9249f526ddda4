// Boxes are of what textured triangles hide: nothing that hides lies outside of them, and where
// textures are empty they are small.
#include "bvh/opaque_part.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "bvh/triangle_opacity.hpp"
#include "scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// A texture with `count` texels that hide.
Texture sparse(std::uint32_t width, std::uint32_t height, unsigned count, unsigned seed) {
  Texture texture{"sparse", width, height, {}};
  texture.alpha.assign(std::size_t{width} * height, 0);
  std::mt19937 random(seed);
  for (unsigned i = 0; i < count; ++i) texture.alpha[random() % texture.alpha.size()] = 200;
  return texture;
}

Scene textured_scene(Texture texture, AlphaMode mode = AlphaMode::blend) {
  Scene scene;
  scene.source = "textured";
  scene.textures.push_back(std::move(texture));
  Material material;
  material.alpha_mode = mode;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  return scene;
}

/// Two triangles in z = 0, from (0,0) to (1,1), with the texture once.
void add_card(Scene& scene) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {0, 0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, M44f(), -1});
}

TexturedTriangle random_triangle(std::mt19937& random, float reach, const Texture& texture) {
  std::uniform_real_distribution<float> at(-reach, reach);
  TexturedCorners corners;
  for (V2f& uv : corners.uv) uv = {at(random), at(random)};
  corners.has_texture = true;
  return pack_textured(corners, texture.wrap_s, texture.wrap_t);
}

/// Uniform in the triangle, some on its edges.
V2f random_place(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  V2f at(unit(random), unit(random));
  if (at.x + at.y > 1) at = V2f(1, 1) - at;
  switch (random() % 8) {
    case 0:
      return {0, at.y};
    case 1:
      return {at.x, 0};
    case 2:
      return {at.x, 1 - at.x};
    default:
      return at;
  }
}

TEST(OpaquePart, HoldsAllThatHides) {
  std::mt19937 random(1);
  int hidden = 0, empty = 0;
  double share = 0;
  constexpr unsigned kTriangles = 3000;
  for (unsigned i = 0; i < kTriangles; ++i) {
    Texture texture = i % 3 ? sparse(37, 21, 1 + i % 5, i) : sparse(64, 64, 3, i);
    constexpr Wrap kWraps[] = {Wrap::repeat, Wrap::clamp, Wrap::mirror};
    texture.wrap_s = kWraps[i % 3];
    texture.wrap_t = kWraps[i / 3 % 3];
    const Scene scene = textured_scene(texture);
    const float reach = i % 2 ? 0.2f : 1.6f;
    const std::vector<TexturedTriangle> triangles{random_triangle(random, reach, texture)};
    const OpaquePart part = OpaqueParts(scene, triangles).find(triangles[0]);
    const TextureIntegrals integrals(scene, triangles);
    const V3f foot(100, 0, -3);
    const std::array<V3f, 3> corners{foot, foot + V3f(0.3f, 0.1f, 0), foot + V3f(0, 0.2f, 0.4f)};
    Box3f box, whole;
    for (const V3f& corner : corners) whole.extendBy(corner);
    if (!part.is_empty()) box = part_box(corners, part);
    const V3f rounding(1e-5f);
    const Box3f around = box.isEmpty() ? box : Box3f(box.min - rounding, box.max + rounding);
    share += part.is_empty() ? 0 : (box.size() / whole.size()).length() / std::sqrt(3.0);
    empty += part.is_empty();
    for (int k = 0; k < 200; ++k) {
      const V2f at = random_place(random);
      if (integrals.mean(triangles[0], at.x, at.y, 0) <= 0) continue;
      ++hidden;
      const V3f position = corners[0] * (1 - at.x - at.y) + corners[1] * at.x + corners[2] * at.y;
      ASSERT_TRUE(around.intersects(position)) << "triangle " << i << " at " << at.x << ", " << at.y
                                               << " hides outside of its box: " << position
                                               << " not in " << box.min << " to " << box.max;
    }
  }
  std::printf("%d places hide; %d of %u triangles empty, boxes %.2f as long\n", hidden, empty,
              kTriangles, share / kTriangles);
  EXPECT_GT(hidden, 5000);
  EXPECT_GT(empty, 100);
  EXPECT_LT(share / kTriangles, 0.8);
}

TEST(OpaquePart, IsAllOfATriangleThatHidesAllOver) {
  Texture full{"full", 8, 8, std::vector<std::uint8_t>(64, 1)};
  Scene scene = textured_scene(full);
  add_card(scene);
  const TexturedTriangle triangle = textured_triangle(scene, scene.meshes[0], 0, false);
  const OpaquePart part = OpaqueParts(scene, std::vector{triangle}).find(triangle);
  EXPECT_EQ(part.least, OpaquePart().least);
  EXPECT_EQ(part.most, OpaquePart().most);
  const Box3f box = part_box({V3f(1, 2, 3), V3f(4, 2, 3.5f), V3f(1, 7, 3)}, part);
  EXPECT_EQ(box.min, V3f(1, 2, 3));
  EXPECT_EQ(box.max, V3f(4, 7, 3.5f));
}

TEST(OpaquePart, BoxesAreOfWhatIsThere) {
  Texture corner{"corner", 64, 64, std::vector<std::uint8_t>(64 * 64, 0)};
  corner.wrap_s = corner.wrap_t = Wrap::clamp;  // else the other edges would mix some of it in
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) corner.alpha[y * 64 + x] = 255;
  Scene scene = textured_scene(corner);
  add_card(scene);
  const SceneBvh bvh = build_bvh(scene);
  EXPECT_EQ(bvh.bounds.min, V3f(0, 0, 0));
  // To a texel and an edge's 32nd beyond.
  EXPECT_LE(bvh.bounds.max.x, 0.25f + 1.0f / 16);
  EXPECT_LE(bvh.bounds.max.y, 0.25f + 1.0f / 16);
  EXPECT_GE(bvh.bounds.max.x, 0.25f);
}

TEST(OpaquePart, CutOutsThatNothingReachesTheCutoffOfAreNotThere) {
  for (const std::uint8_t alpha : {std::uint8_t{126}, std::uint8_t{128}}) {
    Scene scene =
        textured_scene({"even", 4, 4, std::vector<std::uint8_t>(16, alpha)}, AlphaMode::mask);
    add_card(scene);
    scene.materials.push_back({});
    scene.meshes[0].indices.insert(scene.meshes[0].indices.end(), {0, 1, 3});
    scene.meshes[0].materials.push_back(1);
    const SceneBvh bvh = build_bvh(scene);
    EXPECT_EQ(bvh.statistics.opaque, 1u);
    EXPECT_EQ(bvh.statistics.cut_out, alpha > 127 ? 2u : 0u);
  }
}

TEST(OpaquePart, RaysAreHiddenAsWithoutIt) {
  // The same texture with a texel of 1/255 in each corner, which is next to nothing and makes all
  // of the triangles count.
  Texture texture = sparse(32, 32, 40, 7);
  Scene sparse_card = textured_scene(texture);
  for (const std::size_t texel : {0, 31, 31 * 32, 32 * 32 - 1}) texture.alpha[texel] = 1;
  Scene full_card = textured_scene(texture);
  for (Scene* scene : {&sparse_card, &full_card}) add_card(*scene);
  const SceneOnDevice part(sparse_card), all(full_card);
  ASSERT_EQ(all.bvh.bounds.max, V3f(1, 1, 0));
  const auto rays = rays_through(all.bvh.bounds, 20000, 3, 0.05f, 5);
  const auto found = part.trace(rays, Estimator::exact),
             expected = all.trace(rays, Estimator::exact);
  int hidden = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hidden += expected[i].transmittance < 0.9f;
    ASSERT_NEAR(found[i].transmittance, expected[i].transmittance, 0.004f) << "ray " << i;
  }
  EXPECT_GT(hidden, 300);
}

}  // namespace
}  // namespace dapple
