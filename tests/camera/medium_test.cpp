// Media: camera rays treat sparse, uniform nodes as homogeneous media (Loubet and Neyret 2017) when
// the picture may have errors. Coverage, AO and normals must agree with those of traced rays, for
// every splitting factor, in instances, and in every packet.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "bvh/opacity/quantize_opacity.hpp"
#include "camera/view.hpp"
#include "dapple/render.hpp"
#include "dapple/shared/opacity.h"
#include "support/same_bits.hpp"

namespace dapple {
namespace {

Scene cloud(int leaves = 100'000, float opacity = 0.2f) {
  return make_procedural("scene:cloud?leaves=" + std::to_string(leaves) +
                         "&opacity=" + std::to_string(opacity));
}

/// Small triangles in a unit cube, with normals that are nearly vertical.
Scene flakes() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> at(0.0f, 1.0f), tilt(-0.3f, 0.3f);
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = 0.2f;
  Mesh mesh;
  constexpr float kSide = 0.003f;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const V3f p(at(random), at(random), at(random));
    mesh.positions.insert(mesh.positions.end(), {p, p + V3f(kSide, kSide * tilt(random), 0),
                                                 p + V3f(0, kSide * tilt(random), -kSide)});
    mesh.indices.insert(mesh.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    mesh.materials.push_back(0);
  }
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({});
  Camera from_above;
  from_above.to_world.rotate(V3f(-0.7f, 0, 0));
  const auto& back = from_above.to_world[2];
  const V3f eye = V3f(0.5f) + 3.0f * V3f(back[0], back[1], back[2]);
  for (int axis = 0; axis < 3; ++axis) from_above.to_world[3][axis] = eye[axis];
  scene.cameras = {from_above};
  return scene;
}

/// Options of a picture with many samples. With `medium` it has a high target error, so that media
/// are used.
RenderOptions well_sampled(bool medium) {
  RenderOptions options;
  options.width = options.height = 48;
  options.light = false;
  options.spp = options.max_spp = 64;
  options.footprint_spp = 1;
  if (medium) options.target_rmse = 0.05f;
  return options;
}

const std::vector<float>& channel(const RenderResult& result, const char* name) {
  return result.film.find(name)->pixels;
}

double sum(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Compares the picture's mean alpha and mean occlusion with those of the same picture without
/// media. Tolerances: depths of equal nodes are rounded to the same code, up to 4 % off; and a hit
/// point in a medium may be outside of the surfaces that occlude it.
void expect_shows_the_same(const Scene& scene, RenderOptions with) {
  RenderOptions without = with;
  without.target_rmse = 0;
  const RenderResult medium = render(scene, with), rays = render(scene, without);
  EXPECT_LT(medium.statistics.camera.visits, 0.15 * rays.statistics.camera.visits) << "no medium";
  EXPECT_NEAR(sum(channel(medium, "A")) / sum(channel(rays, "A")), 1, 0.04);
  const double pixels = with.width * with.height;
  const double occlusion = pixels - sum(channel(rays, "ao.R"));
  EXPECT_GT(occlusion, 0.001 * pixels) << "nothing to see";
  EXPECT_NEAR((pixels - sum(channel(medium, "ao.R"))) / occlusion, 1, 0.27);
}

TEST(MediumOnDevice, ShowsTheSameWithFewerNodeVisits) {
  expect_shows_the_same(cloud(), well_sampled(true));
}

TEST(MediumOnDevice, ShowsTheSameHoweverManySamplesShareARay) {
  for (const int depths : {1, 2, 4}) {
    SCOPED_TRACE(depths);
    RenderOptions options = well_sampled(true);
    options.camera_splitting = depths;
    options.spp = options.max_spp = 128 / depths;
    expect_shows_the_same(cloud(), options);
  }
}

TEST(MediumOnDevice, ShowsTheSameInPlacedMeshes) {
  Scene scene = cloud();
  for (V3f& position : scene.meshes[0].positions) position *= 10;
  M44f one, other;
  one.scale(V3f(0.1f, 0.05f, 0.2f));
  one.translate(V3f(-10, 0, 0));
  other.scale(V3f(-0.1f, 0.1f, 0.1f));
  other.rotate(V3f(0.4f, 1.2f, -0.7f));
  scene.instances = {scene.instances[0], scene.instances[0]};
  scene.instances[0].to_world = one;
  scene.instances[1].to_world = other;
  expect_shows_the_same(scene, well_sampled(true));
}

TEST(MediumOnDevice, ShowsTheSameToParallelRays) {
  Scene scene = cloud();
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 2.2f;
  camera.to_world.translate(V3f(0, 2.5f, 10));
  scene.cameras = {camera};
  expect_shows_the_same(scene, well_sampled(true));
}

void expect_same_normals(const Scene& scene) {
  const RenderResult medium = render(scene, well_sampled(true));
  const RenderResult rays = render(scene, well_sampled(false));
  EXPECT_LT(medium.statistics.camera.visits, 0.5 * rays.statistics.camera.visits) << "no medium";
  const auto &a = channel(medium, "A"), &b = channel(rays, "A");
  for (const char* name : {"N.X", "N.Y", "N.Z"}) {
    double of_medium = 0, of_rays = 0, count = 0;
    for (std::size_t p = 0; p < a.size(); ++p) {
      if (a[p] < 0.02f || b[p] < 0.02f) continue;  // too few samples
      of_medium += channel(medium, name)[p];
      of_rays += channel(rays, name)[p];
      count += 1;
    }
    ASSERT_GT(count, 100);
    EXPECT_NEAR(of_medium / count, of_rays / count, 0.03) << name;
  }
}

TEST(MediumOnDevice, HasTheNormalsThatRaysFind) { expect_same_normals(flakes()); }

TEST(MediumOnDevice, HasTheNormalsOfPlacedMeshes) {
  Scene scene = flakes();
  M44f flat;
  flat.rotate(V3f(0.5f, 0, 0.9f));  // rotation first, then non-uniform scale
  flat.scale(V3f(1, 0.4f, 1));
  scene.instances[0].to_world = flat;
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world[3][0] = 0.4f;
  expect_same_normals(scene);
}

TEST(MediumOnDevice, ACropEqualsThatPartOfThePictureBitForBit) {
  const Scene scene = cloud();
  RenderOptions options = well_sampled(true);
  options.spp = options.max_spp = 8;
  const Film whole = render(scene, options).film;
  options.crop = PixelRect{13, 9, 39, 20};
  const Film part = render(scene, options).film;
  for (const char* name : {"ao.R", "bent.X", "A", "N.X", "P.Z", "Z"}) {
    std::vector<float> cropped;
    const std::vector<float>& pixels = whole.find(name)->pixels;
    for (int y = options.crop->y0; y <= options.crop->y1; ++y)
      cropped.insert(cropped.end(), pixels.begin() + y * whole.width + options.crop->x0,
                     pixels.begin() + y * whole.width + options.crop->x1 + 1);
    EXPECT_TRUE(same_bits(part.find(name)->pixels, cropped)) << name;
  }
}

TEST(MediumOnDevice, IsUsedOnlyWhereThePictureMayHaveErrors) {
  const Scene scene = cloud(100);
  std::vector<std::string> notes;
  const auto error_of = [&](const RenderOptions& options) {
    return camera_params(choose_view(scene, options, notes), options, {}).medium_error;
  };
  RenderOptions options = well_sampled(true);
  EXPECT_GT(error_of(options), 0);
  options.target_rmse = 0;
  EXPECT_EQ(error_of(options), 0) << "no target";
  options.target_error = 0.05f;
  EXPECT_GT(error_of(options), 0);
  options.light = true;
  EXPECT_EQ(error_of(options), 0) << "lights";
  options.light = false;
  options.footprint = 0;
  EXPECT_EQ(error_of(options), 0) << "no footprints";
  options.footprint = 4;
  options.estimator = Estimator::exact;
  EXPECT_EQ(error_of(options), 0) << "exact";
}

TEST(MediumOnDevice, ErrorIsHalfOfTheTarget) {
  const Scene scene = cloud(100);
  std::vector<std::string> notes;
  RenderOptions options = well_sampled(true);
  options.footprint_spp = 0;
  options.spp = 1;
  options.max_spp = 4096;
  for (const float target : {0.05f, 0.02f, 0.005f}) {
    options.target_rmse = target;
    const View view = choose_view(scene, options, notes);
    EXPECT_NEAR(camera_params(view, options, {}).medium_error, 0.5f * target, 0.1f * target);
  }
}

NodeOpacity opacity_of(float axes, float clumping) {
  NodeOpacity opacity;
  opacity.axes = V3f(axes);
  opacity.clumping = clumping;
  return opacity;
}

TEST(OpacityVariance, CountsDeviationsAndClumping) {
  EXPECT_EQ(variance_class(opacity_of(0, 0)), 0u);
  EXPECT_EQ(variance_class(opacity_of(0.06f, 0)), 0u) << "0.06^2 is below 2^-8";
  EXPECT_EQ(variance_class(opacity_of(0.065f, 0)), 1u);
  EXPECT_EQ(variance_class(opacity_of(0.18f, 0)), 7u);
  EXPECT_EQ(variance_class(opacity_of(1, 0)), 7u);
  // A hundredth of the area is opaque: the standard deviation is the root of 0.01 * 0.99.
  EXPECT_EQ(variance_class(opacity_of(0.01f, 1)), 7u);
  // The root of 0.01 * 0.99 * 0.01 is 0.00995: between 2^(2/2 - 8) and 2^(3/2 - 8).
  EXPECT_EQ(variance_class(opacity_of(0.01f, 0.01f)), 3u);
  EXPECT_EQ(variance_class(opacity_of(0.01f, std::nanf(""))), 7u);
}

TEST(OpacityVariance, IsStoredInTheLowestBitsOfCorrelations) {
  BvhNode node{};
  const Box3f box(V3f(0), V3f(1));
  set_grid(node, box);
  set_child_box(node, 3, box);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    NodeOpacity opacity = opacity_of(0.01f + 0.05f * std::fabs(any(random)),
                                     std::fabs(any(random)) * (i % 2 == 0 ? 0.02f : 1.0f));
    const V3f n(any(random), any(random), i % 5 == 0 ? 0.0f : any(random));
    opacity.normals.add(n, 1);
    if (i % 3 == 0) opacity.normals.add(V3f(any(random), any(random), any(random)), 1);
    set_child_opacity(node, 3, opacity, box);
    EXPECT_EQ(variance_of_child(node, 3), variance_class(opacity));
    for (int pair = 0; pair < 3; ++pair) {
      const float stored = decode_correlation(node.correlation[pair][3]);
      EXPECT_LE(std::fabs(stored), 1.0f);
      EXPECT_NEAR(stored, opacity.normals.correlation()[pair], 0.5001f / 15);
    }
  }
}

}  // namespace
}  // namespace dapple
