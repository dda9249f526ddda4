// --target-error and --target-rmse: pixels are sampled until the estimated error of each pixel, or
// of the whole picture, is below the target. The real error must agree with the estimate, and the
// bits must be the same on every run.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>

#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "dapple/shared/pass_params.h"

namespace dapple {
namespace {

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 48;
  options.height = 40;
  return options;
}

RenderResult draw(const RenderOptions& options) {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  scene.lights = {key_light(scene, frame_scene(scene, 1.2f))};
  return render(std::move(scene), options);
}

const std::vector<float>& channel(const RenderResult& result, const char* name) {
  const Plane* plane = result.film.find(name);
  EXPECT_NE(plane, nullptr) << name;
  return plane->pixels;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(AdaptiveSampling, EveryPixelEndsBelowTheTargetOrAtTheMaximum) {
  RenderOptions options = small_picture();
  options.target_error = 0.03f;
  options.max_spp = 512;
  const RenderResult result = draw(options);
  const auto& samples = channel(result, "samples");
  const auto &ao = channel(result, "error.ao"), &light = channel(result, "error.light.key");
  std::uint64_t total = 0;
  float min = 1e9f, max = 0;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    EXPECT_EQ(std::fmod(samples[p], static_cast<float>(DAPPLE_SAMPLE_BATCH)), 0) << p;
    EXPECT_TRUE(samples[p] >= 512 || (ao[p] <= 0.0301f && light[p] <= 0.0301f)) << p;
    min = std::min(min, samples[p]);
    max = std::max(max, samples[p]);
    total += static_cast<std::uint64_t>(samples[p]);
  }
  EXPECT_EQ(min, 16) << "sky needs no more than the minimum";
  EXPECT_GT(max, 64) << "leaves do";
  EXPECT_LE(max, 512);
  EXPECT_EQ(result.statistics.rays.camera, total) << "the samples layer tells the truth";
}

TEST(AdaptiveSampling, TheErrorOfThePictureIsThatOfTheErrorLayers) {
  RenderOptions options = small_picture();
  options.target_error = 0.03f;
  const RenderResult adaptive = draw(options);
  RenderOptions many = small_picture();
  many.spp = 4096;
  many.footprint_spp = footprint_samples(options);  // the same truth needs the same footprints
  const RenderResult truth = draw(many);
  const auto &a = channel(adaptive, "ao.R"), &b = channel(truth, "ao.R"),
             &e = channel(adaptive, "error.ao");
  double square = 0, predicted = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    square += (a[p] - b[p]) * (a[p] - b[p]);
    predicted += e[p] * e[p];
  }
  // The sum of squares of 1,900 pixels is known to 5 %. All samples together are better stratified
  // than each batch, so the real error is smaller than the batches indicate.
  EXPECT_LT(square, 1.2 * predicted);
  EXPECT_GT(square, 0.2 * predicted);
  EXPECT_NEAR(mean(a), mean(b), 0.003);
}

TEST(AdaptiveSampling, ByRmseTheErrorOfThePictureIsTheTarget) {
  RenderOptions options = small_picture();
  options.spp = 8;
  options.target_rmse = 0.015f;
  const RenderResult adaptive = draw(options);
  RenderOptions many = small_picture();
  many.spp = 4096;
  many.footprint_spp = footprint_samples(options);
  const RenderResult truth = draw(many);
  for (const char* pass : {"ao", "light.key"}) {
    const std::string name(pass);
    const auto &a = channel(adaptive, (name + ".R").c_str()),
               &b = channel(truth, (name + ".R").c_str()),
               &e = channel(adaptive, ("error." + name).c_str());
    // Errors of a light are relative to its largest irradiance without occlusion: about the
    // brightest pixel's.
    const double scale = name == "ao" ? 1.0 : *std::max_element(b.begin(), b.end());
    double square = 0, predicted = 0;
    for (std::size_t p = 0; p < a.size(); ++p) {
      square += (a[p] - b[p]) * (a[p] - b[p]) / (scale * scale);
      predicted += e[p] * e[p];
    }
    const double rmse = std::sqrt(square / static_cast<double>(a.size()));
    const double estimate = std::sqrt(predicted / static_cast<double>(a.size()));
    EXPECT_LE(estimate, 0.015) << name;
    EXPECT_NEAR(adaptive.statistics.rmse.at(name), estimate, 1e-6) << name;
    // The RMSE of 1,900 pixels is known to 3 %; stratification over several batches lowers it.
    EXPECT_LT(rmse, 1.1 * estimate) << name;
    EXPECT_GT(rmse, 0.5 * estimate) << name;
    EXPECT_NEAR(mean(a) / scale, mean(b) / scale, 0.001) << name;
  }
}

TEST(AdaptiveSampling, ByRmseTheSamplesLayerIsRightAndTheSkyHasTheMinimum) {
  RenderOptions options = small_picture();
  options.spp = 8;
  options.target_rmse = 0.01f;
  const RenderResult result = draw(options);
  const auto& samples = channel(result, "samples");
  const auto [min, max] = std::minmax_element(samples.begin(), samples.end());
  EXPECT_EQ(*min, 8);
  EXPECT_GT(*max, 100);
  EXPECT_EQ(result.statistics.rays.camera,
            static_cast<std::uint64_t>(std::accumulate(samples.begin(), samples.end(), 0.0)));
}

/// Node visits of all camera and AO rays: most of a picture's cost.
double node_visits(const RenderStatistics& s) {
  return s.camera.visits * static_cast<double>(s.rays.camera) +
         s.ao.visits * static_cast<double>(s.rays.ao);
}

TEST(AdaptiveSampling, ByRmseTheSameErrorCostsLess) {
  RenderOptions options;
  options.width = 96;  // smaller ones have few tiles: 0.86 to 1.03 by seeds
  options.height = 80;
  options.spp = 8;
  options.light = false;
  options.footprint_spp = 16;
  options.target_error = 0.02f;
  const RenderStatistics equal = draw(options).statistics;
  options.target_error = 0;
  options.target_rmse = static_cast<float>(equal.rmse.at("ao"));
  EXPECT_LT(node_visits(draw(options).statistics), 0.95 * node_visits(equal)) << "0.90";
}

TEST(AdaptiveSampling, TheSameCommandGivesTheSameBits) {
  RenderOptions options = small_picture();
  for (float RenderOptions::*target : {&RenderOptions::target_error, &RenderOptions::target_rmse}) {
    options.target_error = options.target_rmse = 0;
    options.*target = 0.03f;
    const RenderResult first = draw(options), again = draw(options);
    ASSERT_EQ(first.film.planes.size(), again.film.planes.size());
    for (std::size_t i = 0; i < first.film.planes.size(); ++i) {
      const auto &a = first.film.planes[i].pixels, &b = again.film.planes[i].pixels;
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
          << first.film.planes[i].channel;
    }
  }
}

TEST(AdaptiveSampling, AHalvedTargetTakesAboutFourTimesTheSamples) {
  RenderOptions options = small_picture();
  options.light = false;
  options.target_error = 0.04f;
  const double coarse = static_cast<double>(draw(options).statistics.rays.camera);
  options.target_error = 0.02f;
  const double fine = static_cast<double>(draw(options).statistics.rays.camera);
  const double min_samples = 16.0 * options.width * options.height;
  EXPECT_GT((fine - min_samples) / (coarse - min_samples), 3.0);
  EXPECT_LT((fine - min_samples) / (coarse - min_samples), 8.0);
}

TEST(AdaptiveSampling, InvalidOptionsAreRefused) {
  RenderOptions options;
  options.target_error = -0.1f;
  EXPECT_THROW(validate(options), Error);
  options.target_error = 0.1f;
  options.max_spp = 4;
  EXPECT_THROW(validate(options), Error) << "less than --spp";
  options.max_spp = 64;
  validate(options);
  options.target_rmse = 0.1f;
  EXPECT_THROW(validate(options), Error) << "both targets";
  options.target_error = 0;
  validate(options);
  options.max_spp = 4;
  EXPECT_THROW(validate(options), Error) << "less than --spp";
}

// Batches have four samples.
TEST(AdaptiveSampling, TheMaximumIsKeptAndTheSameCommandResumes) {
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("dapple_adaptive_" + std::to_string(getpid()) + ".ckpt"))
                               .string();
  for (const int max_spp : {3, 10, 50}) {
    RenderOptions options = small_picture();
    options.target_rmse = 1e-4f;
    options.spp = 1;
    options.max_spp = max_spp;
    Scene scene = make_procedural("scene:tree?leaves=2000");
    scene.lights = {key_light(scene, frame_scene(scene, 1.2f))};
    RenderControl control;
    control.checkpoint = file;
    const RenderResult first = render(scene, options, control);
    const auto& samples = channel(first, "samples");
    const float least = 2 * DAPPLE_SAMPLE_BATCH;
    EXPECT_LE(*std::max_element(samples.begin(), samples.end()),
              std::max(least, static_cast<float>(max_spp)));
    control.resume = file;
    EXPECT_EQ(channel(render(scene, options, control), "ao.R"), channel(first, "ao.R")) << max_spp;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace dapple
