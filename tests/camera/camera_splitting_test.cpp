// Camera splitting (Arvo and Kirk 1990): several samples share a camera ray. The splitting factor
// depends on the scene's opacities; the picture stays the same, with less noise where rays cross
// many thin surfaces.
#include "camera/camera_splitting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "dapple/render.hpp"

namespace dapple {
namespace {

Scene tree(float opacity) {
  Scene scene = make_procedural("scene:tree?leaves=20000");
  override_opacity(scene, "leaf", opacity);
  return scene;
}

RenderOptions small_picture(int splitting) {
  RenderOptions options;
  options.width = 48;
  options.height = 40;
  options.camera_splitting = splitting;
  return options;
}

const std::vector<float>& channel(const RenderResult& result, const char* name) {
  return result.film.find(name)->pixels;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rmse(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double{a[i]} - b[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

int splitting_of(const RenderOptions& options, const Scene& scene) {
  std::vector<std::string> notes;
  return choose_camera_splitting(options, scene, choose_view(scene, options, notes));
}

TEST(CameraSplitting, IncreasesWithTheTransmittanceOfSurfaces) {
  for (const auto& [opacity, factor] :
       {std::pair(1.0f, 1), {0.9f, 1}, {0.85f, 2}, {0.5f, 2}, {0.2f, 4}})
    EXPECT_EQ(splitting_of({}, tree(opacity)), factor) << opacity;
  RenderOptions options;
  options.camera_splitting = 2;
  EXPECT_EQ(splitting_of(options, tree(0.2f)), 2) << "the given factor";
}

/// A tree whose leaves have a texture of 2x1 texels with these alphas.
Scene cards(std::uint8_t left, std::uint8_t right) {
  Scene scene = tree(1.0f);
  scene.textures.push_back({"alpha", 2, 1, {left, right}});
  for (Mesh& mesh : scene.meshes) mesh.uvs.resize(mesh.positions.size(), V2f(0.0f));
  for (Material& material : scene.materials) material.alpha_texture = 0;
  return scene;
}

TEST(CameraSplitting, DependsOnTheAlphaOfTextures) {
  EXPECT_EQ(splitting_of({}, cards(0, 255)), 1) << "holes and opaque leaf";
  EXPECT_EQ(splitting_of({}, cards(51, 51)), 4) << "as an opacity of 0.2";
  EXPECT_EQ(splitting_of({}, cards(0, 128)), 2) << "what is not there doesn't count";
}

TEST(CameraSplitting, DependsOnTexturesAsThePictureFiltersThem) {
  Scene scene = cards(0, 255);
  // Texels far smaller than a pixel of the default picture act as an opacity of one half.
  for (Mesh& mesh : scene.meshes) {
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v)
      mesh.uvs[v] = V2f(mesh.positions[v].x + mesh.positions[v].z, mesh.positions[v].y) * 1e5f;
  }
  EXPECT_EQ(splitting_of({}, scene), 4);
  RenderOptions exact;
  exact.estimator = Estimator::exact;
  EXPECT_EQ(splitting_of(exact, scene), 1) << "which averages nothing";
}

/// A tree in which a share `part` of all triangles is thin.
Scene partly_thin(double part) {
  Scene scene = tree(1.0f);
  scene.materials.push_back(scene.materials.front());
  scene.materials.back().name = "thin";
  for (Mesh& mesh : scene.meshes) {
    const auto count =
        static_cast<std::ptrdiff_t>(part * static_cast<double>(mesh.materials.size()));
    std::fill_n(mesh.materials.begin(), count,
                static_cast<std::uint32_t>(scene.materials.size() - 1));
  }
  override_opacity(scene, "thin", 0.1f);
  return scene;
}

TEST(CameraSplitting, IsNotUsedForAFewThinSurfaces) {
  EXPECT_EQ(splitting_of({}, partly_thin(0.05)), 1);
  EXPECT_EQ(splitting_of({}, partly_thin(0.15)), 2);
  EXPECT_EQ(splitting_of({}, partly_thin(0.3)), 4);
}

TEST(CameraSplitting, LeavesRoomForAllSamples) {
  RenderOptions options;
  options.spp = 1 << 20;
  options.ao_rays = 8;
  EXPECT_EQ(splitting_of(options, tree(0.2f)), 2);
  options.ao_rays = 16;
  EXPECT_EQ(splitting_of(options, tree(0.2f)), 1);
}

TEST(CameraSplitting, GivesTheSamePictureWithLessNoise) {
  // The same number of AO rays a camera sample for all, and no footprints.
  RenderOptions many = small_picture(1);
  many.spp = 1024;
  many.ao_rays = 4;
  many.estimator = Estimator::exact;
  const RenderResult truth = render(tree(0.2f), many);
  std::vector<double> errors;
  for (const int factor : {1, 2, 4}) {
    RenderOptions options = many;
    options.camera_splitting = factor;
    options.spp = 16;
    const RenderResult result = render(tree(0.2f), options);
    for (const char* name : {"A", "ao.R", "light.sky.G", "N.Y", "bent.Y"}) {
      const auto &found = channel(result, name), &expected = channel(truth, name);
      const double error_of_mean =
          rmse(found, expected) / std::sqrt(static_cast<double>(found.size()));
      // Unit vectors along sums of few rays are biased: they have the length of one, not of a mean.
      const double bias = name == std::string("bent.Y") ? 0.01 : 0;
      EXPECT_NEAR(mean(found), mean(expected), 3 * error_of_mean + bias) << name << ", " << factor;
    }
    errors.push_back(rmse(channel(result, "ao.R"), channel(truth, "ao.R")));
  }
  EXPECT_LT(errors[1], 0.93 * errors[0]);  // 0.90
  EXPECT_LT(errors[2], 0.9 * errors[0]);
}

TEST(CameraSplitting, CountsCameraSamplesAndTheirRays) {
  RenderOptions options = small_picture(4);
  options.spp = 3;
  options.light_rays = 2;
  const RenderResult result = render(tree(0.2f), options);
  for (const float samples : channel(result, "samples")) EXPECT_EQ(samples, 3);
  const auto& rays = result.statistics.rays;
  EXPECT_EQ(rays.camera, 3u * 48 * 40);
  EXPECT_EQ(rays.light, 4 * rays.ao) << "one AO ray and two rays to each light a depth";
  const double hits = mean(channel(result, "A")) * 48 * 40 * 3 * 4;
  EXPECT_NEAR(static_cast<double>(rays.ao), hits, 1e-4 * hits);
}

TEST(CameraSplitting, FootprintsAreAsLargeAsWithoutIt) {
  for (const float target_rmse : {0.0f, 0.01f}) {
    RenderOptions options = small_picture(4);
    options.spp = 12;
    options.target_rmse = target_rmse;
    const RenderOptions traced = by_sample(options);
    EXPECT_EQ(traced.spp, 48);
    EXPECT_EQ(footprint_samples(traced), footprint_samples(options));
    EXPECT_EQ(footprint_ao_rays(traced), footprint_ao_rays(options));
  }
}

TEST(CameraSplitting, ErrorsWithATargetAreThoseOfWholeCameraRays) {
  RenderOptions many = small_picture(1);
  many.spp = 2048;
  const std::vector<float> truth = channel(render(tree(0.2f), many), "ao.R");
  for (const int factor : {2, 4}) {
    RenderOptions options = small_picture(factor);
    options.spp = 2;
    options.light = false;
    options.target_rmse = 0.015f;
    options.footprint_spp = many.spp;
    const RenderResult result = render(tree(0.2f), options), again = render(tree(0.2f), options);
    const std::vector<float>& ao = channel(result, "ao.R");
    // Samples of one ray are correlated. If they counted as independent, the error would be
    // underestimated.
    EXPECT_LT(rmse(ao, truth), 0.016) << factor;
    EXPECT_GT(rmse(ao, truth), 0.011) << factor;
    EXPECT_EQ(std::memcmp(ao.data(), channel(again, "ao.R").data(), ao.size() * sizeof(float)), 0);
    for (const float samples : channel(result, "samples")) EXPECT_GE(samples, 2);
  }
}

TEST(CameraSplitting, ACropEqualsThatPartOfThePicture) {
  RenderOptions options = small_picture(4);
  options.spp = 5;
  const RenderResult whole = render(tree(0.2f), options);
  options.crop = PixelRect{7, 5, 40, 30};
  const RenderResult part = render(tree(0.2f), options);
  for (const char* name : {"A", "Z", "P.X", "ao.R", "light.sun.R"})
    for (int y = 5; y <= 30; ++y)
      for (int x = 7; x <= 40; ++x)
        ASSERT_EQ(channel(whole, name)[static_cast<std::size_t>(y) * 48 + x],
                  channel(part, name)[static_cast<std::size_t>(y - 5) * 34 + (x - 7)])
            << name << " at " << x << ", " << y;
}

}  // namespace
}  // namespace dapple
