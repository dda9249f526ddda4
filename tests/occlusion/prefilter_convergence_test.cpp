// Pictures come nearer to exact each time that the footprint's scale is halved, once noise is
// taken out; dapple-bench accuracy --images-only shows larger ones.
#include <gtest/gtest.h>

#include <filesystem>

#include "support/scene_on_device.hpp"
#include "render/picture.hpp"

namespace dapple {
namespace {

using scene_test::device;
using scene_test::SceneOnDevice;

constexpr float kFootprints[] = {4, 2, 1, 1 / 2.0f, 1 / 4.0f, 1 / 8.0f, 1 / 16.0f};
constexpr int kSeeds = 36;

using Pixels = std::vector<double>;

/// AO sums over a picture's samples, through the camera that render() would choose.
class Pictures {
 public:
  explicit Pictures(const SceneOnDevice& scene) : scene_(scene) {
    options_.width = options_.height = 48;
    options_.light = false;
    std::vector<std::string> notes;
    view_ = choose_view(scene.scene, options_, notes);
  }

  /// Mean AO of each pixel; footprint 0 is exact.
  [[nodiscard]] Pixels ao(float footprint, int seed) const {
    RenderOptions options = options_;
    options.estimator = footprint > 0 ? Estimator::prefiltered : Estimator::exact;
    options.footprint = footprint;
    options.seed = static_cast<std::uint32_t>(seed);
    const FilmLayout layout(view_, options, scene_.bvh.bounds, {});
    const TracedPicture picture =
        trace_picture(device(), scene_.uploaded, view_, options, layout, {});
    // Misses add nothing to the plane, exact or not: they drop out of differences.
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

/// Mean squares of what the differences of infinitely many seeds would average to. Products of
/// one seed's differences with another's hold no noise in the mean, so those with its own are
/// left out; leaving out every seed in turn tells how sure the result is (the jackknife).
class ConvergedSquare {
 public:
  explicit ConvergedSquare(const std::vector<Pixels>& differences) {
    for (const Pixels& a : differences) {
      for (const Pixels& b : differences) products_.push_back(mean_product(a, b));
    }
  }

  /// Without one seed; with -1 of all.
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

  std::vector<double> products_;  ///< seed by seed
};

/// Standard error of one value less another: seeds are the same, so they vary together.
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
  // Rises are looked for from every larger scale on, so that slow ones add up. Of 21 comparisons
  // a scene one in 200 scenes would have one beyond 3.5 standard errors by noise alone.
  for (std::size_t small = 1; small < squares.size(); ++small) {
    for (std::size_t large = 0; large < small; ++large) {
      EXPECT_LE(squares[small].value(),
                squares[large].value() + 3.5 * error_of_difference(squares[small], squares[large]))
          << name << " from footprint " << kFootprints[large] << " to " << kFootprints[small];
    }
  }
  // All in all half of the square goes, and the first holds something that could.
  const double error = error_of_difference(squares.back(), squares.front());
  EXPECT_LE(squares.back().value(), squares.front().value() / 2 + 3 * error) << name;
  EXPECT_GT(squares.front().value(), 0) << name;
}

/// Rays all through the scene, with footprints of whole twigs that the scale makes nothing.
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
  // Otherwise the line above has shown nothing.
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
