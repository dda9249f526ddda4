// Interrupted renders that continue from a checkpoint end with the same bits as uninterrupted ones,
// wherever they stopped. A larger number of samples continues a picture; other settings are refused
// with the name of the option.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "render/partial/checkpoint.hpp"
#include "render/picture.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace film_test;
using scene_test::device;
using scene_test::SceneOnDevice;

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 40;
  options.height = 36;
  options.spp = 40;
  options.ao_rays = 32;  // slices have 8,192 samples
  options.visits = true;
  options.report_bias = 0;  // a report is that of the samples of the last run
  return options;
}

RenderOptions with(float RenderOptions::*target, float value) {
  RenderOptions options = small_picture();
  options.spp = 8;
  options.*target = value;
  return options;
}

Scene lit_tree() {
  Scene scene = make_procedural("scene:tree?leaves=1000");
  std::vector<std::string> notes;
  scene.lights.push_back(key_light(scene, choose_view(scene, small_picture(), notes).camera));
  merge_single_instances(scene);
  return scene;
}

Stop stop_after(int slices) {
  return [left = slices]() mutable { return left-- == 0; };
}

/// Traces a tree on the device, without the preparation and the film of render().
class Tracing {
 public:
  Tracing(const SceneOnDevice& tree, const RenderOptions& options)
      : tree_(tree),
        options_(options),
        view_(choose_view(tree.scene, options, notes_)),
        layout_(view_.crop, options,
                film_scales(view_, tree.bvh.bounds, tree.uploaded.buffers->light_records),
                tree.scene.lights) {}

  [[nodiscard]] TracedPicture trace(const TraceControl& control = {}, TraceState from = {}) const {
    return trace_picture(device(), tree_.uploaded, view_, options_, layout_, control,
                         std::move(from));
  }
  /// The state after `slices` more slices.
  [[nodiscard]] TraceState state_after(int slices, TraceState from = {}) const {
    TraceState state;
    TraceControl control;
    control.stop = stop_after(slices);
    control.save = [&](const TraceState& now) { state = now.copy(); };
    control.save_every = 1e9;
    (void)trace(control, std::move(from));
    return state;
  }

 private:
  const SceneOnDevice& tree_;
  RenderOptions options_;
  std::vector<std::string> notes_;
  View view_;
  FilmLayout layout_;
};

std::vector<std::int64_t> sums_of(const TracedPicture& picture) {
  const auto sums = picture.sums.values<std::int64_t>();
  return {sums.begin(), sums.end()};
}

void expect_same(const TracedPicture& a, const TracedPicture& b) {
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(sums_of(a), sums_of(b));
  ASSERT_EQ(a.errors.size(), b.errors.size());
  for (std::size_t i = 0; i < a.errors.size(); ++i)
    EXPECT_EQ(bits_of(a.errors[i]), bits_of(b.errors[i]));
}

class Resume : public FilmFile {};

/// A state alone makes no file: it says of which picture it is. Tracing doesn't read that.
Checkpoint of_some_picture() {
  Checkpoint checkpoint;
  checkpoint.picture.metadata.samples = 1;
  return checkpoint;
}

TEST_F(Resume, ARenderLeftAfterAnySliceGoesOnToTheSameBits) {
  const SceneOnDevice tree(lit_tree(), {.colors = true});
  RenderOptions split = with(&RenderOptions::target_error, 0.04f);
  split.camera_splitting = 4;
  RenderOptions piloted = with(&RenderOptions::target_rmse, 0.03f);
  piloted.width = 72;
  piloted.height = 64;
  for (const RenderOptions& options : {small_picture(), with(&RenderOptions::target_error, 0.05f),
                                       with(&RenderOptions::target_rmse, 0.02f), split, piloted}) {
    const Tracing tracing(tree, options);
    int slices = 0;
    TraceControl count;
    count.stop = [&] { return ++slices < 0; };
    const TracedPicture whole = tracing.trace(count);
    EXPECT_GT(slices, 6);
    const int step = 1 + slices / 8;
    for (int slice = 0; slice <= slices; slice += step) {
      SCOPED_TRACE(slice);
      write_checkpoint(path("a.ckpt"), of_some_picture(), tracing.state_after(slice));
      expect_same(tracing.trace({}, read_checkpoint(path("a.ckpt")).state), whole);
    }
    TraceState state;
    for (int slice = 0; slice <= slices; ++slice) state = tracing.state_after(1, std::move(state));
    expect_same(tracing.trace({}, std::move(state)), whole);
  }
}

/// The scene with an orthographic camera, whose rays do not start at one point.
Scene seen_from_afar(Scene scene) {
  std::vector<std::string> notes;
  Camera camera = choose_view(scene, small_picture(), notes).camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 3;
  scene.cameras = {camera};
  return scene;
}

void expect_passes_to_add_up(const Scene& scene) {
  const SceneOnDevice tree(scene, {.colors = true});
  RenderOptions options = small_picture();
  options.spp = 100;
  const Tracing tracing(tree, options);
  TraceControl passes;
  passes.order = SampleOrder::sweeps;
  const TracedPicture a = tracing.trace(), b = tracing.trace(passes);
  EXPECT_EQ(a.samples, b.samples);
  const std::size_t pixels = a.samples.size();
  // Visits and tests depend on the other rays of a packet. Their planes are set to 0: planes 8 and
  // 9 of the camera, and those of AO and of the light, before the three that are reflected.
  const auto without_visits = [pixels](const TracedPicture& picture) {
    std::vector<std::int64_t> sums = sums_of(picture);
    for (const std::size_t plane : {8, 9, 14, 15, 21, 22})
      std::fill_n(sums.begin() + static_cast<std::ptrdiff_t>(plane * pixels), pixels, 0);
    return sums;
  };
  EXPECT_EQ(without_visits(a), without_visits(b));
  // The last three planes are the albedo's.
  EXPECT_EQ(sums_of(a).size(), 29 * pixels);
  const auto sums = a.sums.values<std::int64_t>();
  EXPECT_GT(std::count_if(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(pixels),
                          [](std::int64_t hits) { return hits > 0; }),
            100);
}

TEST_F(Resume, PassesOverThePictureAddUpToTheSameBits) { expect_passes_to_add_up(lit_tree()); }

TEST_F(Resume, PassesOfAnOrthographicPictureAddUpToTheSameBits) {
  expect_passes_to_add_up(seen_from_afar(lit_tree()));
}

RenderResult draw(const RenderOptions& options, const RenderControl& control = {}) {
  return render(make_procedural("scene:tree?leaves=1000"), options, control);
}

/// Compares all layers but the visits of rays, which depend on the order in which rays are traced.
void expect_same_film(const Film& a, const Film& b) {
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (const Plane& plane : a.planes) {
    if (plane.channel.starts_with("visits")) continue;
    EXPECT_EQ(bits_of(plane.pixels), bits_of(b.find(plane.channel)->pixels)) << plane.channel;
  }
  // The bias that is reported is that of the samples of a run.
  const auto without_bias = [](auto settings) {
    std::erase_if(settings, [](const auto& setting) { return setting.first.starts_with("bias."); });
    return settings;
  };
  EXPECT_EQ(without_bias(a.metadata.settings), without_bias(b.metadata.settings));
}

TEST_F(Resume, AnInterruptedPictureHoldsTheSamplesSoFarAndItsFileContinues) {
  RenderOptions options = small_picture();
  options.camera_splitting = 1;
  const RenderResult whole = draw(options);
  EXPECT_FALSE(whole.interrupted);
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  control.stop = stop_after(4);
  const RenderResult part = draw(options, control);
  EXPECT_TRUE(part.interrupted);
  const auto& samples = part.film.find("samples")->pixels;
  EXPECT_EQ(part.statistics.rays.camera,
            static_cast<std::uint64_t>(std::accumulate(samples.begin(), samples.end(), 0.0)));
  EXPECT_LT(part.statistics.rays.camera, whole.statistics.rays.camera);
  for (const float count : samples) EXPECT_GE(count, 16) << "whole passes first";
  control.stop = {};
  control.resume = control.checkpoint;
  const RenderResult rest = draw(options, control);
  EXPECT_FALSE(rest.interrupted);
  expect_same_film(rest.film, whole.film);
  EXPECT_EQ(rest.statistics.rays.camera, whole.statistics.rays.camera);
  EXPECT_EQ(files_in_folder(), 1u);
  expect_same_film(draw(options, control).film, whole.film);  // the checkpoint is complete now
}

TEST_F(Resume, PixelsWithoutSamplesEqualPixelsThatMiss) {
  RenderOptions options = small_picture();
  for (const int slices : {0, 2}) {
    RenderControl control;
    control.stop = stop_after(slices);
    const RenderResult part = draw(options, control);
    EXPECT_TRUE(part.interrupted);
    const auto& samples = part.film.find("samples")->pixels;
    int without = 0;
    for (std::size_t p = 0; p < samples.size(); ++p) {
      if (samples[p] > 0) continue;
      ++without;
      EXPECT_EQ(part.film.find("A")->pixels[p], 0);
      EXPECT_EQ(part.film.find("ao.R")->pixels[p], 1);
      EXPECT_EQ(part.film.find("light.sun.R")->pixels[p], 0);
      EXPECT_EQ(part.film.find("visits.nodes")->pixels[p], 0);
      EXPECT_TRUE(std::isinf(part.film.find("Z")->pixels[p]));
    }
    EXPECT_GT(without, slices ? 500 : 1439);
    for (const Plane& plane : part.film.planes)
      for (const float value : plane.pixels) EXPECT_FALSE(std::isnan(value)) << plane.channel;
  }
}

TEST_F(Resume, WithATargetAnInterruptedPictureKnowsItsErrorsOnceAllPixelsHaveTwoBatches) {
  const RenderOptions options = with(&RenderOptions::target_rmse, 0.008f);
  RenderControl control;
  control.stop = stop_after(1);
  const RenderResult early = draw(options, control);
  EXPECT_EQ(early.film.find("error.ao"), nullptr);
  EXPECT_TRUE(early.statistics.rmse.empty());
  control.stop = stop_after(5);
  const RenderResult later = draw(options, control);
  EXPECT_TRUE(later.interrupted);
  ASSERT_NE(later.film.find("error.ao"), nullptr);
  double largest = 0;
  for (const auto& [layer, rmse] : later.statistics.rmse) largest = std::max(largest, rmse);
  EXPECT_GT(largest, 0.008);
}

// Footprints stay those of the first samples.
TEST_F(Resume, MoreSamplesContinueThePictureThatTheFirstBegan) {
  RenderOptions options = small_picture();
  options.spp = 12;
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  for (const int stop : {1000, 1}) {  // from a finished picture, and from a part of one
    control.resume.clear();
    control.stop = stop_after(stop);
    options.spp = 12;
    EXPECT_EQ(draw(options, control).interrupted, stop == 1);
    RenderOptions more = options;
    more.spp = 30;
    control.stop = {};
    control.resume = control.checkpoint;
    const RenderResult continued = draw(more, control);
    more.footprint_spp = 12;
    const RenderResult at_once = draw(more);
    expect_same_film(continued.film, at_once.film);
    more.footprint_spp = 0;
    EXPECT_NE(bits_of(draw(more).film.find("ao.R")->pixels),
              bits_of(at_once.film.find("ao.R")->pixels))
        << "other footprints make another picture";
    more.spp = 41;  // continues again, with the footprints of the first render
    const RenderResult further = draw(more, control);
    more.footprint_spp = 12;
    expect_same_film(further.film, draw(more).film);
  }
}

TEST_F(Resume, ATighterTargetAndALargerSppContinue) {
  RenderOptions options = with(&RenderOptions::target_rmse, 0.03f);
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  draw(options, control);
  control.resume = control.checkpoint;
  options.target_rmse = 0.015f;
  options.spp = 20;
  const RenderResult finer = draw(options, control);
  EXPECT_LE(finer.statistics.rmse.at("ao"), 0.015);
  EXPECT_LE(finer.statistics.rmse.at("light.sun"), 0.015);
  const auto& samples = finer.film.find("samples")->pixels;
  EXPECT_GE(*std::min_element(samples.begin(), samples.end()), 20);
}

TEST_F(Resume, OtherSettingsAreRefusedAndNamed) {
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  draw(small_picture(), control);
  control = {};
  control.resume = path("a.ckpt");
  using Change = std::function<void(RenderOptions&)>;
  const std::pair<const char*, Change> changes[] = {
      {"was made with --seed 0, this run has --seed 2", [](auto& o) { o.seed = 2; }},
      {"--width 40, this run has --width 41", [](auto& o) { o.width = 41; }},
      {"--height 36, this", [](auto& o) { o.height = 35; }},
      {"--crop 0,0,39,35, this run has --crop 1,2,3,4",
       [](auto& o) {
         o.crop = PixelRect{1, 2, 3, 4};
       }},
      {"--estimator prefiltered, this", [](auto& o) { o.estimator = Estimator::exact; }},
      {"--footprint 4, this run has --footprint 4.0000005",
       [](auto& o) { o.footprint = std::nextafter(4.0f, 5.0f); }},
      {"--passes ao,light,albedo, this run has --passes ao,albedo",
       [](auto& o) { o.light = false; }},
      {"--normals shading, this run has --normals geometric",
       [](auto& o) { o.normals = Normals::geometric; }},
      {"--ao-rays 32, this run has --ao-rays 7", [](auto& o) { o.ao_rays = 7; }},
      {"--light-rays 1, this", [](auto& o) { o.light_rays = 2; }},
      {"--ao-distance 0, this", [](auto& o) { o.ao_distance = 3; }},
      {"--target-error or --target-rmse", [](auto& o) { o.target_error = 0.1f; }},
      {"differs from this run in camera",
       [](auto& o) {
         o.look = LookAt{{9, 9, 9}};
       }},
      {"differs from this run in scene",
       [](auto& o) {
         o.opacity = {{"leaf", 0.5f}};
       }},
      {"differs from this run in scene", [](auto& o) { o.ground = true; }},
      {"has 40 samples per pixel already, --spp 39", [](auto& o) { o.spp = 39; }},
      {"footprint_spp 40, this run has 20", [](auto& o) { o.footprint_spp = 20; }},
  };
  for (const auto& [part, change] : changes) {
    RenderOptions options = small_picture();
    change(options);
    const Error error = error_of([&] { draw(options, control); });
    EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
    EXPECT_TRUE(contains(error.what(), std::string("--resume ") + path("a.ckpt") + ": "))
        << error.what();
    EXPECT_TRUE(contains(error.what(), part)) << part << " is not in: " << error.what();
  }
  const auto other_tree = [&] {
    render(make_procedural("scene:tree?leaves=1001"), small_picture(), control);
  };
  EXPECT_TRUE(contains(error_of(other_tree).what(), "differs from this run in scene"));
}

TEST_F(Resume, FrequentCheckpointsDoNotChangeThePicture) {
  const RenderOptions options = small_picture();
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  const RenderResult seldom = draw(options, control);
  control.checkpoint_every = 0;  // after every slice
  const RenderResult often = draw(options, control);
  expect_same_film(often.film, seldom.film);
  EXPECT_GT(often.statistics.seconds.checkpoint, 0);
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(Resume, AnUnwritableCheckpointKeepsThePictureAndTheFormerCheckpoint) {
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  const RenderOptions options = small_picture();
  draw(options, control);
  const std::string before = bytes_of(path("a.ckpt"));
  control.checkpoint = path("missing/a.ckpt");
  control.checkpoint_every = 0;
  const RenderResult result = draw(options, control);
  EXPECT_TRUE(contains(result.checkpoint_failure, "missing/a.ckpt")) << result.checkpoint_failure;
  EXPECT_FALSE(result.interrupted);
  EXPECT_TRUE(bytes_of(path("a.ckpt")) == before);
}

}  // namespace
}  // namespace dapple
