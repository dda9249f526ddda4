// Mip footprints (Williams, "Pyramidal Parametrics", 1983): a footprint that covers many texels
// looks up their mean, in the highest mip level whose texels it covers. Tests each grouping of
// rays, instances and camera rays. Exact rays, and surfaces that an average would change, are
// looked up at full resolution.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "bvh/build/coincident_triangles.hpp"
#include "bvh/opacity/opacity_mip_levels.hpp"
#include "dapple/shared/opacity.h"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kTexels = 64;  // along each axis of the texture, and of the card

Texture noise() {
  Texture texture{"noise", kTexels, kTexels, {}};
  texture.nearest = true;
  std::mt19937 random(1);
  for (int i = 0; i < kTexels * kTexels; ++i)
    texture.alpha.push_back(static_cast<std::uint8_t>(random() >> 24));
  return texture;
}

/// A square of side 1 m in the plane z = 0, with texture coordinates from (0,0) to (1,1).
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {0, 0};
  return mesh;
}

Scene card(AlphaMode mode, Texture texture = noise()) {
  Scene scene;
  scene.source = "card";
  scene.textures.push_back(std::move(texture));
  Material material;
  material.name = "card";
  material.alpha_mode = mode;
  material.alpha = 0.9f;
  material.alpha_cutoff = 0.4f;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  scene.meshes.push_back(square());
  scene.instances.push_back({0, M44f(), -1});
  return scene;
}

/// A ray's key for which footprint_spread() returns 1.
constexpr std::uint32_t kNoSpread = 0x6a09e667u;

/// Rays along -z to texels of the card. The part of their footprint over which textures are
/// averaged is twice the area of a square of 2^level texels a side, half the area of the next
/// larger square. `scale`: the card's side in the world.
std::vector<Ray> rays_at_texels(int level, float scale = 1) {
  Points points(2);
  std::vector<Ray> rays;
  for (int i = 0; i < 400; ++i) {
    const float x = std::floor(points.unit() * kTexels) + 0.5f;
    const float y = std::floor(points.unit() * kTexels) + 0.25f;
    Ray ray = make_ray(V3f(x / kTexels, y / kTexels, 1) * scale, {0, 0, -1});
    ray.first_area =
        2 / DAPPLE_TEXTURE_FOOTPRINT * std::ldexp(scale * scale / (kTexels * kTexels), 2 * level);
    ray.key = kNoSpread;
    rays.push_back(ray);
  }
  return rays;
}

/// The opacity of the mip level where the ray hits the card.
float expected_opacity(const OpacityMipLevels& mip_levels, const Ray& ray, int level,
                       float scale = 1) {
  const OpacityMipLevels::Level& at = mip_levels.levels()[static_cast<std::size_t>(level)];
  const int x = static_cast<int>(ray.origin[0] / scale * static_cast<float>(at.width));
  const int y = static_cast<int>(ray.origin[1] / scale * static_cast<float>(at.height));
  return at.opacity[static_cast<std::size_t>(y) * at.width + x];
}

constexpr double kCode = 0.5 / 255 + 1e-4;  // rounding of 8-bit means, and of depths in packets

TEST(MipFootprint, IsTheLargestSquareThatTheFootprintCovers) {
  for (const Packets packets : {Packets::none, Packets::pixel, Packets::point}) {
    const Device chosen("", "", packets);
    for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
      const Scene scene = card(mode);
      const SceneBvh bvh = build_bvh(scene);
      const DeviceScene uploaded = upload(chosen, scene, bvh);
      // Blended surfaces multiply by the factor last, cut-outs before the threshold.
      const bool blended = mode == AlphaMode::blend;
      const OpacityMipLevels mip_levels(scene.textures[0], blended ? 1.0f : 0.9f,
                                        blended ? -1 : 0.4f);
      for (const int level : {0, 1, 2, 3}) {
        const auto rays = rays_at_texels(level);
        const auto found = trace(chosen, uploaded, rays, Estimator::prefiltered, 1.0f);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const float opacity =
              (blended ? 0.9f : 1.0f) * expected_opacity(mip_levels, rays[i], level);
          ASSERT_NEAR(found[i].transmittance, 1 - opacity, kCode)
              << "level " << level << ", traced " << static_cast<int>(packets);
        }
      }
    }
  }
}

TEST(MipFootprint, IsAtMostAThirtySecondOfTheTriangle) {
  const SceneOnDevice scene(card(AlphaMode::blend));
  const OpacityMipLevels mip_levels(scene.scene.textures[0], 1, -1);
  const auto rays = rays_at_texels(5);  // squares of 1024 texels; a triangle has 2048
  const auto found = scene.trace(rays, Estimator::prefiltered);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_NEAR(found[i].transmittance, 1 - 0.9 * expected_opacity(mip_levels, rays[i], 3), kCode);
}

TEST(MipFootprint, IsNotUsedForExactRaysNorForZeroFootprints) {
  const SceneOnDevice scene(card(AlphaMode::mask));
  const auto rays = rays_at_texels(3), narrow = rays_at_texels(-8);
  const auto exact = scene.trace(rays, Estimator::exact);
  const auto none = scene.trace(rays, Estimator::prefiltered, 0.0f);
  const auto fine = scene.trace(narrow, Estimator::prefiltered);
  const auto wide = scene.trace(rays, Estimator::prefiltered);
  int between = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float found = exact[i].transmittance;
    ASSERT_TRUE(found == 0.0f || found == 1.0f) << "cut-outs are opaque or invisible";
    ASSERT_EQ(none[i].transmittance, found);
    ASSERT_EQ(fine[i].transmittance, found);
    between += wide[i].transmittance > 0.0f && wide[i].transmittance < 1.0f;
  }
  EXPECT_EQ(between, 400) << "or the others show nothing";
}

TEST(MipFootprint, IsMeasuredInTheSpaceOfInstances) {
  Scene placed = card(AlphaMode::blend);
  const float scale = 8;
  placed.instances[0].to_world.setScale(scale);
  const SceneOnDevice scene(std::move(placed));
  const OpacityMipLevels mip_levels(scene.scene.textures[0], 1, -1);
  for (const int level : {1, 3}) {
    const auto rays = rays_at_texels(level, scale);
    const auto found = scene.trace(rays, Estimator::prefiltered);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_NEAR(found[i].transmittance,
                  1 - 0.9 * expected_opacity(mip_levels, rays[i], level, scale), kCode);
  }
}

/// Expects lookups at full resolution, for rays whose footprints cover 8 x 8 texels.
void expect_full_resolution(Scene scene) {
  const SceneOnDevice on_device(std::move(scene));
  const auto rays = rays_at_texels(3);
  const auto found = on_device.trace(rays, Estimator::prefiltered);
  const auto exact = on_device.trace(rays, Estimator::exact);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_EQ(found[i].transmittance, exact[i].transmittance);
}

TEST(MipFootprint, IsNotUsedForCutOutsWithVertexAlpha) {
  Scene varying = card(AlphaMode::mask);
  varying.materials[0].uses_vertex_alpha = true;
  varying.meshes[0].vertex_alpha = {1, 0.5f, 1, 0.5f};
  expect_full_resolution(std::move(varying));
}

TEST(MipFootprint, IsNotUsedForCoincidentCards) {
  Scene doubled = card(AlphaMode::mask);
  Mesh& mesh = doubled.meshes[0];
  for (const std::uint32_t corner : {2u, 1u, 0u, 3u, 2u, 0u}) mesh.indices.push_back(corner);
  mesh.materials.assign(4, 0);
  expect_full_resolution(std::move(doubled));
}

TEST(MipFootprint, CoincidentTrianglesAreFoundInAnyOrderOfTheirCorners) {
  Mesh mesh = square();
  mesh.positions.push_back({-0.0f, 0, 0});  // beside corner 0
  mesh.indices.insert(mesh.indices.end(), {2, 4, 1, 1, 2, 3});
  mesh.materials.assign(4, 0);
  const std::vector<std::uint32_t> all{0, 1, 2, 3}, some{1, 2, 3};
  EXPECT_EQ(find_coincident(mesh, all), (std::vector<std::uint8_t>{1, 0, 1, 0}));
  EXPECT_EQ(find_coincident(mesh, some), (std::vector<std::uint8_t>{0, 0, 0}));
}

Texture checks() {
  Texture texture{"checks", kTexels, kTexels, {}};
  texture.nearest = true;
  for (int y = 0; y < kTexels; ++y)
    for (int x = 0; x < kTexels; ++x)
      texture.alpha.push_back((x + y) % 2 ? std::uint8_t{255} : std::uint8_t{0});
  return texture;
}

/// The different coverages of 4x4 pixels, each 16 texels wide, of a checkered card that fills the
/// picture.
std::set<float> coverages(RenderOptions options, float instance_scale) {
  Scene scene = card(AlphaMode::blend, checks());
  scene.materials[0].alpha = 1;
  scene.instances[0].to_world.setScale(instance_scale);
  // Two instances, one out of sight, so that the card is not merged into the world.
  add_triangles_out_of_sight(scene.meshes[0]);
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world[3][2] = 50;
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 0.5f * instance_scale;
  camera.to_world.setTranslation(V3f(0.5f, 0.5f, 1) * instance_scale);
  scene.cameras.push_back(camera);
  options.width = options.height = 4;
  options.spp = 4;
  options.light = false;
  const RenderResult result = render(scene, options);
  const std::vector<float>& alpha = result.film.find("A")->pixels;
  return {alpha.begin(), alpha.end()};
}

// Of four stratified thresholds two are below one half. Where every mip footprint has an opacity of
// one half, two of four samples stop in every pixel.
TEST(MipFootprint, OfACameraRayIsThatOfItsPixel) {
  for (const float scale : {1.0f, 0.02f}) {
    RenderOptions options;
    options.camera_splitting = 1;
    EXPECT_EQ(coverages(options, scale), (std::set<float>{0.5f})) << scale;
    options.estimator = Estimator::exact;
    EXPECT_GT(coverages(options, scale).size(), 1u) << "texels are black or white";
  }
}

}  // namespace
}  // namespace dapple
