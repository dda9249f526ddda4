// Footprints of points of different kinds: some under a roof, others under leaves, whose biases one
// correction cannot take out.
#include "points/local_footprint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

/// The RMSE over tiles is proportional to the footprint.
class KnownBias : public BiasSource {
 public:
  KnownBias(double of_one, double noise) : of_one_(of_one), noise_(noise) {}
  void grow(std::size_t) override {}
  [[nodiscard]] bool is_complete() const override { return true; }
  std::vector<Bias> bias(float footprint) override {
    Bias bias;
    bias.mean = 0.5;  // which is corrected
    bias.tile_rmse = of_one_ * double{footprint};
    bias.tile_rmse_limit = std::sqrt(bias.tile_rmse * bias.tile_rmse + 2 * noise_ * noise_);
    return {Bias(), bias};
  }

 private:
  double of_one_, noise_;
};

// 0.1 / sqrt(64) is 0.0125.
TEST(LocalFootprint, IsHalvedUntilWhatIsLeftIsLessThanTheNoise) {
  const auto chosen = [](double of_one, double noise) {
    KnownBias source(of_one, noise);
    return choose_local_footprint(source, 1, 64);
  };
  EXPECT_EQ(chosen(0.012, 0).footprint, 1);
  EXPECT_EQ(chosen(0.012, 0).note, "");
  EXPECT_EQ(chosen(0.014, 0).footprint, 0.5f);
  EXPECT_EQ(chosen(0.09, 0).footprint, 0.125f);
  EXPECT_EQ(chosen(0.19, 0).footprint, 0.0625f);
  EXPECT_EQ(chosen(0.3, 0).footprint, 0);
  EXPECT_EQ(chosen(0.014, 0.01).footprint, 1) << "this may be noise";
  EXPECT_NE(chosen(0.09, 0).note.find("by about 0.0900"), std::string::npos);
}

/// A tree, and a round roof beside it, both with points below.
struct Garden {
  Scene scene = make_procedural("scene:tree?leaves=20000");
  std::vector<V3f> points, normals;
  std::size_t roofed = 64;  ///< of the points, the first ones
  Garden() {
    Mesh roof;
    const V3f centre(30, 1, 0);
    roof.positions.push_back(centre);
    constexpr int kSides = 256;
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * scene_test::kPi * i / kSides;
      roof.positions.push_back(centre + V3f(static_cast<float>(std::cos(angle)), 0,
                                            static_cast<float>(-std::sin(angle))));
      const auto at = static_cast<std::uint32_t>(i);
      roof.indices.insert(roof.indices.end(), {0, 1 + at, 1 + (at + 1) % kSides});
    }
    roof.materials.assign(kSides, static_cast<std::uint32_t>(scene.materials.size()));
    scene.materials.emplace_back();
    scene_test::place(scene, std::move(roof));
    for (int i = 0; i < static_cast<int>(roofed); ++i) points.emplace_back(30, 0, 0);
    for (int i = 0; i < 576; ++i)
      points.emplace_back(0.25f * static_cast<float>(i % 24 - 12), 0.01f,
                          0.25f * static_cast<float>(i / 24 - 12));
    normals.assign(points.size(), V3f(0, 1, 0));
  }

  /// Mean AO below the roof, and the mean of what is said to be its standard error.
  [[nodiscard]] std::pair<double, double> below_roof(const PointOptions& options) const {
    const PointResult found = measure_points(scene, points, normals, options);
    double ao = 0, error = 0;
    for (std::size_t i = 0; i < roofed; ++i) {
      ao += double{found.columns.at(0).values.at(i)};
      error += double{found.columns.at(1).values.at(i)};
    }
    const auto count = static_cast<double>(roofed);
    return {ao / count, error / count};
  }
};

// A disk at a distance of its radius hides half of the sky.
TEST(LocalFootprint, PointsBelowARoofAreRightBesidePointsBelowATree) {
  const Garden garden;
  PointOptions options;
  options.sky_view_factor = false;
  options.rays = 64;
  EXPECT_NEAR(garden.below_roof(options).first, 0.5, 0.02);
  options.max_bias = 0;
  const auto [kept, error] = garden.below_roof(options);
  EXPECT_GT(kept, 0.54) << "with the footprint as it is";
  Garden alone;
  alone.points.resize(alone.roofed);
  alone.normals.resize(alone.roofed);
  EXPECT_GT(error, 1.3 * alone.below_roof(options).second) << "what is left counts as an error";
}

// All of them equal: what is left is the mean, which the correction takes out with any rays.
TEST(LocalFootprint, EqualPointsAreRightWithFewRays) {
  Garden garden;
  garden.roofed = 2000;
  garden.points.assign(garden.roofed, V3f(30, 0, 0));
  garden.normals.assign(garden.roofed, V3f(0, 1, 0));
  PointOptions options;
  options.sky_view_factor = false;
  options.max_bias = 0;
  for (const int rays : {8, 16, 64}) {
    options.rays = rays;
    EXPECT_NEAR(garden.below_roof(options).first, 0.5, 0.03) << rays;
  }
}

}  // namespace
}  // namespace dapple
