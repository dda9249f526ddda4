#include "rivals/protocols/image_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <numbers>

#include "rivals/protocols/ray_protocol.hpp"
#include "rivals/reference_cache.hpp"

namespace dapple::bench {
namespace {

constexpr std::uint32_t kReferenceSeeds[2] = {0x7e000001u, 0x7e000002u};
constexpr int kCalibrationRounds = 5;

/// Samples per pixel of the picture that gives the largest unoccluded irradiance.
constexpr int kLargestSpp = 256;

/// Minimum samples per pixel of the adaptive contestants.
constexpr int kAdaptiveSpp = 1;

/// Samples of pictures that Embree's methods are tried out with, in all and a pixel at most.
constexpr std::uint32_t kCalibrationSamples = 1u << 20;
constexpr int kMostCalibrationSpp = 16;

/// Numbers of AO rays per camera sample of Embree's contestants.
constexpr std::uint32_t kEmbreeRays[] = {1, 2};

/// AO rays per camera sample of the contestant with point packets.
constexpr int kPacketRays = 16;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds of the fastest of several interleaved rounds of each method, so that disturbances do not
/// decide the choice.
std::vector<double> try_out(const std::vector<EmbreeMethod>& methods,
                            const std::function<void(const EmbreeMethod&)>& work) {
  std::vector<double> fastest(methods.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < kCalibrationRounds; ++round)
    for (std::size_t m = 0; m < methods.size(); ++m)
      fastest[m] = std::min(fastest[m], seconds_of([&] { work(methods[m]); }));
  return fastest;
}

std::vector<Light> lights_of(Pass pass, const Scene& scene) {
  return pass == Pass::light ? scene.lights : std::vector<Light>{};
}

}  // namespace

ImageStudy::ImageStudy(RivalScene& scene, Pass pass, ImageOptions options)
    : scene_(scene),
      pass_(pass),
      options_(std::move(options)),
      pictures_(scene.embree, scene.view, lights_of(pass, scene.ours.scene())) {
  set_largest();
}

RenderOptions ImageStudy::render_options(int spp, std::uint32_t seed) const {
  RenderOptions options = scene_.options;
  options.ao = pass_ == Pass::ao;
  options.light = pass_ == Pass::light;
  options.spp = spp;
  options.seed = seed;
  return options;
}

void ImageStudy::set_largest() {
  largest_ = {1.0};
  if (pass_ == Pass::light) {
    RenderOptions options = render_options(kLargestSpp, 0);
    scene_.ours.set_largest({});
    largest_ = scene_.ours.render(options).largest;
  }
  scene_.ours.set_largest(largest_);
}

std::vector<double> ImageStudy::relative(std::vector<double> irradiance) const {
  const std::size_t pixels = irradiance.size() / largest_.size();
  for (std::size_t i = 0; i < irradiance.size(); ++i)
    irradiance[i] /= largest_[i / pixels] > 0 ? largest_[i / pixels] : 1.0;
  return irradiance;
}

Truth ImageStudy::truth() {
  const PictureMethod method{{Alpha::stochastic, 16, false, false},
                             {Alpha::multiplicative, 1, false, false}};
  const int half = (options_.reference_spp + 1) / 2;
  const ReferenceHalves halves = cached_reference(
      options_.cache, reference_key(), scene_.view.pixel_count() * largest_.size(),
      [&](int number) {
        return pictures_.render(pass_, half, kReferenceSeeds[number], method, kReferenceBlack);
      });
  return truth_of_halves(relative(halves.first), relative(halves.second));
}

std::string ImageStudy::reference_key() const {
  return reference_key_text(scene_, pass_ == Pass::ao ? "ao" : "light", options_.reference_spp);
}

void ImageStudy::calibrate() {
  const bool flat = scene_.geometry.flat;
  // With few samples a batch has few rays of each pixel, and packets are less coherent.
  const int spp = std::clamp(static_cast<int>(kCalibrationSamples / scene_.view.pixel_count()), 1,
                             kMostCalibrationSpp);
  const std::vector<EmbreeMethod> cameras = camera_methods(flat);
  const EmbreeMethod camera =
      best_of_each_alpha(cameras, try_out(cameras, [&](const EmbreeMethod& method) {
                           pictures_.trace_camera_rays(spp, 0, method);
                         }))[0];
  const std::vector<EmbreeMethod> occlusions = occlusion_methods(flat);
  const auto seconds = try_out(occlusions, [&](const EmbreeMethod& method) {
    (void)pictures_.render(pass_, spp, 0, {camera, method}, kContestBlack);
  });
  for (const EmbreeMethod& best : best_of_each_alpha(occlusions, seconds)) {
    for (const std::uint32_t rays : kEmbreeRays)
      if (rays == 1 || pass_ == Pass::ao) methods_.push_back({camera, best, rays});
  }
}

std::vector<Contestant> ImageStudy::contestants() {
  calibrate();
  std::vector<Contestant> contestants;
  for (const PictureMethod& method : methods_) contestants.push_back(by_embree(method));
  RenderOptions changes = scene_.options;
  changes.estimator = Estimator::exact;
  contestants.push_back(by_dapple("exact", changes));
  changes.estimator = Estimator::prefiltered;
  contestants.push_back(by_dapple("prefiltered", changes));
  if (pass_ == Pass::ao) {
    // Point packets need many rays per sample. This has fewer camera rays, and more AO rays for
    // each.
    changes.ao_rays = kPacketRays;
    contestants.push_back(by_dapple("prefiltered, 16 rays a sample", changes));
  }
  contestants.push_back(adaptive("adaptive", &RenderOptions::target_error, 5));
  contestants.push_back(adaptive("adaptive, least RMSE", &RenderOptions::target_rmse, 10));
  return contestants;
}

Contestant ImageStudy::by_embree(const PictureMethod& method) {
  const std::string rays =
      method.ao_rays == 1 ? "" : fmt::format(", {} rays a sample", method.ao_rays);
  Contestant contestant{"Embree " + method.occlusion.name() + rays, true, true, {}, {}};
  for (int spp = 1; spp <= options_.most_spp; spp *= 2) contestant.ladder.push_back(spp);
  contestant.run = [this, method](double spp, std::uint32_t seed) {
    Outcome outcome;
    outcome.seconds = seconds_of([&] {
      outcome.values = pictures_.render(pass_, static_cast<int>(spp), seed, method, kContestBlack);
    });
    outcome.values = relative(std::move(outcome.values));
    return outcome;
  };
  return contestant;
}

Outcome ImageStudy::render(const RenderOptions& options) {
  const Picture picture = scene_.ours.render(options);
  Outcome outcome{picture.trace_seconds, {}};
  for (const PicturePass& pass : picture.passes)
    outcome.values.insert(outcome.values.end(), pass.pixels.begin(), pass.pixels.end());
  return outcome;
}

Contestant ImageStudy::by_dapple(const std::string& name, const RenderOptions& changes) {
  Contestant contestant{name, false, changes.estimator == Estimator::exact, {}, {}};
  for (int spp = 1; spp <= options_.most_spp; spp *= 2) contestant.ladder.push_back(spp);
  contestant.run = [this, changes](double spp, std::uint32_t seed) {
    RenderOptions options = render_options(static_cast<int>(spp), seed);
    options.estimator = changes.estimator;
    options.ao_rays = changes.ao_rays;
    return render(options);
  };
  return contestant;
}

Contestant ImageStudy::adaptive(const std::string& name, float RenderOptions::*target,
                                double first) {
  Contestant contestant{name, false, false, {}, {}};
  for (double inverse_error = first; inverse_error < 150; inverse_error *= std::numbers::sqrt2)
    contestant.ladder.push_back(inverse_error);
  contestant.run = [this, target](double inverse_error, std::uint32_t seed) {
    RenderOptions options = render_options(kAdaptiveSpp, seed);
    options.estimator = Estimator::prefiltered;
    options.*target = static_cast<float>(1 / inverse_error);
    return render(options);
  };
  return contestant;
}

}  // namespace dapple::bench
