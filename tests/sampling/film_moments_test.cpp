// The moments that adaptive sampling derives from a picture's sums: variances of batches, and the
// irradiance by which errors of lights are divided.
#include "sampling/film_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "render/picture.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

constexpr int kSide = 8;
constexpr float kLightScale = 0x1p26f;

/// A picture with one light. Every sample hits something that is not lit; the batches' means have
/// the variance `of_batch`.
class UnlitPicture {
 public:
  UnlitPicture(std::vector<std::uint32_t> samples, float of_batch)
      : of_batch_(of_batch),
        samples_(std::move(samples)),
        layout_({0, 0, kSide - 1, kSide - 1}, options_, {1, 1, {kLightScale}}, {Light{}}) {
    sums_.resize(std::size_t{layout_.pixels} * layout_.plane_count);
    for (std::uint32_t p = 0; p < layout_.pixels; ++p) sums_[p] = samples_[p];
    add_squares(DAPPLE_SAMPLE_BATCH, of_batch_);
    add_squares(2 * DAPPLE_SAMPLE_BATCH, of_batch_ / 2);
  }

  void set_unoccluded(std::uint32_t pixel, double irradiance) {
    sums_[std::size_t{layout_.lights[0].unoccluded()} * layout_.pixels + pixel] =
        std::llround(irradiance * samples_[pixel] * layout_.lights[0].scale);
  }

  /// The irradiance by which FilmMoments divides the light's errors.
  [[nodiscard]] double largest_unoccluded() const {
    const HostView sums(nullptr, std::as_bytes(std::span(sums_)));
    const HostView squares(nullptr, std::as_bytes(std::span(squares_)));
    const FilmMoments moments(sums, squares, layout_, options_, samples_, kSide);
    const double largest = std::sqrt(of_batch_ / moments.variances().at(0).at(0));
    // Finds the variances one by one, and only those that it needs.
    EXPECT_NEAR(moments.largest_values().at(0), largest, 1e-5);
    return largest;
  }

 private:
  /// Appends a plane of sums of squares: means of `samples` samples each, around 0, with
  /// `variance`.
  void add_squares(std::uint32_t samples, float variance) {
    for (const std::uint32_t of_pixel : samples_) {
      const auto means = static_cast<float>(of_pixel / samples);
      squares_.push_back(variance * std::max(0.0f, means - 1));
    }
  }
  static RenderOptions unlit_options() {
    RenderOptions options;
    options.ao = false;
    return options;
  }

  float of_batch_;
  RenderOptions options_ = unlit_options();
  std::vector<std::uint32_t> samples_;
  FilmLayout layout_;
  std::vector<std::int64_t> sums_;
  std::vector<float> squares_;
};

std::vector<std::uint32_t> alike(std::uint32_t samples) {
  return std::vector<std::uint32_t>(kSide * kSide, samples);
}

constexpr std::uint32_t kBright = 3 * kSide + 3, kBesideIt = 3 * kSide + 2;

TEST(FilmMoments, LightsErrorsAreRelativeToTheLargestUnoccludedIrradianceLessItsStandardError) {
  UnlitPicture picture(alike(16), 0.25f);
  picture.set_unoccluded(kBright, 4);
  picture.set_unoccluded(kBesideIt, 2);
  // The mean of four batches of variance 1/4 has a standard error of 1/4.
  EXPECT_NEAR(picture.largest_unoccluded(), 4 - 0.25, 1e-5);
}

TEST(FilmMoments, NoisyIrradianceIsAveragedOverNeighbours) {
  UnlitPicture picture(alike(16), 100);
  picture.set_unoccluded(kBright, 4);
  picture.set_unoccluded(kBesideIt, 2);
  EXPECT_NEAR(picture.largest_unoccluded(), 6.0 / 9, 1e-5);
}

TEST(FilmMoments, OfManyNoisyPixelsTheLargestIsTheSameWithAllVariancesAndWithFew) {
  UnlitPicture picture(alike(16), 0.25f);
  for (std::uint32_t p = 0; p < kSide * kSide; ++p)
    picture.set_unoccluded(p, 3 + 0.05 * (p * 37 % 64));
  EXPECT_NEAR(picture.largest_unoccluded(), 3 + 0.05 * 63 - 0.25, 1e-5);
}

TEST(FilmMoments, PilotPixelsStandForOthers) {
  std::vector<std::uint32_t> samples = alike(8);
  for (int p = kSide * kSide / 2; p < kSide * kSide; ++p) samples[p] = 0;
  UnlitPicture picture(samples, 0.25f);
  picture.set_unoccluded(kBright, 4);
  picture.set_unoccluded(kBesideIt, 2);
  EXPECT_NEAR(picture.largest_unoccluded(), 4, 1e-5);
}

// Numbers with a given sum have the smallest sum of squares when they are equal, and the means of
// pairs are closer together than the numbers.
TEST(FilmMoments, KernelsSquareTheMeansOfBatchesAndOfPairs) {
  const scene_test::SceneOnDevice cloud(make_procedural("scene:cloud?leaves=300"));
  RenderOptions options;
  options.light = options.albedo = false;
  options.width = options.height = 16;
  options.spp = options.max_spp = 28;  // seven batches: three pairs and a single batch
  options.target_error = 1e-6f;        // without a target, states have no squares
  options.camera_splitting = 1;
  std::vector<std::string> notes;
  const View view = choose_view(cloud.scene, options, notes);
  const FilmLayout layout(view.crop, options, film_scales(view, cloud.bvh.bounds, {}), {});
  TraceState state;
  TraceControl control;
  control.save = [&](const TraceState& now) { state = now.copy(); };
  control.save_every = 1e9;
  (void)trace_picture(scene_test::device(), cloud.uploaded, view, options, layout, control);
  ASSERT_EQ(state.squares.size(), 2u * layout.pixels);
  const double scale = 1.0 / (double{layout.unit_scale} * options.ao_rays);
  double least = 0, pairs = 0, batches = 0;
  for (std::uint32_t p = 0; p < layout.pixels; ++p) {
    const double sum = static_cast<double>(state.sums[p]) -
                       static_cast<double>(state.sums[layout.ao * layout.pixels + p]) * scale;
    const double of_pixel[] = {3.5 * std::pow(sum / options.spp, 2),
                               state.squares[layout.pixels + p], 0.5 * state.squares[p]};
    EXPECT_LE(of_pixel[0], of_pixel[1] + 1e-5) << p;
    EXPECT_LE(of_pixel[1], of_pixel[2] + 1e-5) << p;
    least += of_pixel[0];
    pairs += of_pixel[1];
    batches += of_pixel[2];
  }
  // Seven batches have six degrees of freedom; three pairs and a single batch have three.
  EXPECT_LT(1.01 * least, pairs);
  EXPECT_LT(pairs - least, 0.6 * (batches - least));
  EXPECT_GT(pairs - least, 0.2 * (batches - least));
}

}  // namespace
}  // namespace dapple
