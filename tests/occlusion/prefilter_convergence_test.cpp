// Pictures approach the exact picture each time the footprint's scale is halved, after their noise
// is removed. `dapple-bench accuracy --images-only` does the same with larger pictures.
#include <gtest/gtest.h>

#include <filesystem>

#include "render/picture.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using scene_test::device;
using scene_test::SceneOnDevice;

constexpr float kFootprints[] = {4, 2, 1, 1 / 2.0f, 1 / 4.0f, 1 / 8.0f, 1 / 16.0f};
constexpr int kSeeds = 36;

using Pixels = std::vector<double>;

/// AO of small pictures with the camera that render() would choose.
class Pictures {
 public:
  explicit Pictures(const SceneOnDevice& scene) : scene_(scene) {
    options_.width = options_.height = 48;
    options_.light = options_.albedo = false;
    std::vector<std::string> notes;
    view_ = choose_view(scene.scene, options_, notes);
  }

  /// Mean AO of each pixel; footprint 0 is exact.
  [[nodiscard]] Pixels ao(float footprint, int seed) const {
    RenderOptions options = options_;
    options.estimator = footprint > 0 ? Estimator::prefiltered : Estimator::exact;
    options.footprint = footprint;
    options.seed = static_cast<std::uint32_t>(seed);
    const FilmLayout layout(view_.crop, options, film_scales(view_, scene_.bvh.bounds, {}), {});
    const TracedPicture picture =
        trace_picture(device(), scene_.uploaded, view_, options, layout, {});
    // Misses add nothing to this plane, exact or prefiltered, so they cancel in differences.
    const auto first =
        picture.sums.values<std::int64_t>().begin() + std::ptrdiff_t{layout.ao} * layout.pixels;
    Pixels pixels(first, first + layout.pixels);
    for (double& pixel : pixels) pixel /= double{layout.unit_scale} * options.spp;
    return pixels;
  }

 private:
  const SceneOnDevice& scene_;
  RenderOptions options_;
  View view_;
};

/// Mean square of the differences that infinitely many seeds would give on average. The product of
/// two seeds' differences has no noise in the mean; products of a seed with itself are left out.
/// Leaving out each seed in turn gives the standard error (the jackknife).
class ConvergedSquare {
 public:
  explicit ConvergedSquare(const std::vector<Pixels>& differences) {
    for (const Pixels& a : differences) {
      for (const Pixels& b : differences) products_.push_back(mean_product(a, b));
    }
  }

  /// The mean square without one seed; with -1, of all seeds.
  [[nodiscard]] double value(int without = -1) const {
    double sum = 0;
    int count = 0;
    for (int a = 0; a < kSeeds; ++a) {
      for (int b = 0; b < kSeeds; ++b) {
        if (a == b || a == without || b == without) continue;
        sum += products_[static_cast<std::size_t>(a * kSeeds + b)];
        ++count;
      }
    }
    return sum / count;
  }

 private:
  static double mean_product(const Pixels& a, const Pixels& b) {
    double sum = 0;
    for (std::size_t p = 0; p < a.size(); ++p) sum += a[p] * b[p];
    return sum / static_cast<double>(a.size());
  }

  std::vector<double> products_;  ///< one entry per pair of seeds
};

/// Standard error of the difference of two values. They use the same seeds, so they are correlated.
double error_of_difference(const ConvergedSquare& a, const ConvergedSquare& b) {
  double sum = 0, squares = 0;
  for (int without = 0; without < kSeeds; ++without) {
    const double d = a.value(without) - b.value(without);
    sum += d;
    squares += d * d;
  }
  return std::sqrt((kSeeds - 1) * std::max(0.0, squares / kSeeds - sum * sum / (kSeeds * kSeeds)));
}

ConvergedSquare converged_square(const Pictures& pictures, const std::vector<Pixels>& exact,
                                 float footprint) {
  std::vector<Pixels> differences;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Pixels d = pictures.ao(footprint, seed);
    for (std::size_t p = 0; p < d.size(); ++p) d[p] -= exact[static_cast<std::size_t>(seed)][p];
    differences.push_back(std::move(d));
  }
  return ConvergedSquare(differences);
}

void expect_pictures_converge(const SceneOnDevice& scene, const std::string& name) {
  const Pictures pictures(scene);
  std::vector<Pixels> exact;
  for (int seed = 0; seed < kSeeds; ++seed) exact.push_back(pictures.ao(0, seed));
  std::vector<ConvergedSquare> squares;
  std::printf("%s, converged RMSE:", name.c_str());
  for (const float footprint : kFootprints) {
    squares.push_back(converged_square(pictures, exact, footprint));
    std::printf(" %g: %.4f", footprint, std::sqrt(std::max(0.0, squares.back().value())));
  }
  std::printf("\n");
  // Each scale is compared with every larger one, so that slow increases add up. By noise alone,
  // one of the 21 comparisons is beyond 3.5 standard errors in one of 200 scenes.
  for (std::size_t small = 1; small < squares.size(); ++small) {
    for (std::size_t large = 0; large < small; ++large) {
      EXPECT_LE(squares[small].value(),
                squares[large].value() + 3.5 * error_of_difference(squares[small], squares[large]))
          << name << " from footprint " << kFootprints[large] << " to " << kFootprints[small];
    }
  }
  // From the largest scale to the smallest, the mean square must at least halve, and must not be 0
  // at the largest.
  const double error = error_of_difference(squares.back(), squares.front());
  EXPECT_LE(squares.back().value(), squares.front().value() / 2 + 3 * error) << name;
  EXPECT_GT(squares.front().value(), 0) << name;
}

/// Rays through the whole scene. Their footprints cover whole twigs; scaled to 0, they must give
/// exact results.
void expect_equal_rays(const SceneOnDevice& scene, const std::string& name) {
  const Box3f& box = scene.bvh.bounds;
  const std::vector<Ray> rays =
      scene_test::rays_through(box, 20'000, box.size().length() / 2, 0.05f, 11);
  const auto exact = scene.trace(rays, Estimator::exact);
  const auto count_different = [&](float footprint) {
    const auto found = scene.trace(rays, Estimator::prefiltered, footprint);
    int count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // A millionth is eight roundings: compilers may order the product otherwise.
      count += std::fabs(found[i].transmittance - exact[i].transmittance) > 1e-6f;
    }
    return count;
  };
  EXPECT_EQ(count_different(0), 0) << name;
  // Otherwise the footprints are too small for this test.
  EXPECT_GT(count_different(1), 2000) << name;
}

void expect_convergence(Scene scene, const std::string& name) {
  merge_single_instances(scene);
  const SceneOnDevice on_device(std::move(scene));
  expect_equal_rays(on_device, name);
  expect_pictures_converge(on_device, name);
}

TEST(PrefilterConvergence, PicturesOfATreeAndOfACloudComeNearerToExactWithEveryHalving) {
  expect_convergence(make_procedural("scene:tree"), "tree");
  expect_convergence(make_procedural("scene:cloud"), "cloud");
}

TEST(PrefilterConvergence, PicturesOfTheSaplingAndThePineComeNearerToExactWithEveryHalving) {
  const std::string folder = DAPPLE_SHARED_SCENES;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here: left out";
  for (const float opacity : {0.85f, 0.2f}) {
    Scene sapling = load_scene(folder + "/sapling_100k.glb");
    override_opacity(sapling, "leaf", opacity);
    expect_convergence(std::move(sapling), "sapling at " + std::to_string(opacity));
  }
  expect_convergence(load_scene(folder + "/smallpine/scene.gltf"), "pine");
}

}  // namespace
}  // namespace dapple
