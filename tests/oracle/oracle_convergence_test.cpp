// Compares the prefiltered estimator with the exact one as the footprint's scale goes to 0: both
// have the same integral in the limit, and nearly the same at the default scale.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "oracle/embree_oracle.hpp"
#include "oracle/oracle_rays.hpp"
#include "oracle/oracle_scenes.hpp"

namespace dapple::oracle {
namespace {

/// The first is larger than the default of 1, so that its bias is large enough to see it shrink.
constexpr float kFootprints[] = {16, 1, 1.0f / 4, 1.0f / 16, 1.0f / 1024, 0};

Film film_of(const Scene& scene, Estimator estimator, float footprint) {
  RenderOptions options;
  options.width = options.height = 96;
  options.light = false;
  options.estimator = estimator;
  options.footprint = footprint;
  options.roulette = 0;  // footprint 0 composites every surface
  return render(scene, options).film;
}

/// Difference of the AO of two pictures with the same camera rays and AO directions.
struct Difference {
  double mean = 0;   ///< over the rays that hit the scene; the sky would lower it
  double error = 0;  ///< standard error of `mean`, estimated from the pixels
  double rms = 0;    ///< over all pixels
};

Difference difference(const Film& film, const Film& exact) {
  const std::vector<float>& a = film.find("ao.R")->pixels;
  const std::vector<float>& b = exact.find("ao.R")->pixels;
  double sum = 0, squares = 0, covered = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = double{a[i]} - b[i];
    sum += d;
    squares += d * d;
    covered += exact.find("A")->pixels[i];
  }
  return {sum / covered, std::sqrt(squares) / covered,
          std::sqrt(squares / static_cast<double>(a.size()))};
}

void expect_convergence_of_pictures(const Scene& scene, const char* name) {
  const Film exact = film_of(scene, Estimator::exact, 1);
  Difference larger{1, 0, 1};
  for (const float footprint : kFootprints) {
    const Difference found = difference(film_of(scene, Estimator::prefiltered, footprint), exact);
    std::printf("%s, footprint %g: mean AO %+.5f +- %.5f from exact, rms of a pixel %.5f\n", name,
                footprint, found.mean, found.error, found.rms);
    // The bias may change its sign; then noise may enlarge it again, by three standard errors.
    EXPECT_LE(std::fabs(found.mean), std::fabs(larger.mean) + 3 * (found.error + larger.error))
        << name << ", footprint " << footprint;
    // Smaller footprints replace fewer surfaces. An rms that is at its maximum may vary by 1 %.
    EXPECT_LE(found.rms, 1.01 * larger.rms) << name << ", footprint " << footprint;
    EXPECT_LE(std::fabs(found.mean), footprint > 1 ? 0.1 : 0.02) << name;
    EXPECT_LE(found.rms, footprint > 0 ? 1.0 : 1e-6) << name;
    larger = found;
  }
}

/// Rays whose footprint covers whole twigs: scaled to 0, the footprint must give exact results.
void expect_equal_rays(const Scene& scene, const char* name) {
  const OnDevice on_device(merged(scene));
  const std::vector<Ray> rays = device_rays(random_segments(scene, 4), 0.1f);
  const auto trace_all = [&](Estimator estimator, float footprint) {
    return trace(on_device.device, on_device.uploaded, rays, estimator, footprint);
  };
  const std::vector<Occlusion> exact = trace_all(Estimator::exact, 1);
  const auto count_different = [&](const std::vector<Occlusion>& others) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // A millionth is eight roundings: compilers may order the product otherwise.
      count += std::fabs(others[i].transmittance - exact[i].transmittance) > 1e-6f;
    }
    return count;
  };
  EXPECT_EQ(count_different(trace_all(Estimator::prefiltered, 0)), 0u) << name;
  // Otherwise the footprints are too small for this test.
  EXPECT_GT(count_different(trace_all(Estimator::prefiltered, 1)), kRays / 10) << name;
}

void expect_convergence(const Scene& scene, const char* name) {
  expect_equal_rays(scene, name);
  expect_convergence_of_pictures(scene, name);
}

}  // namespace

TEST(Convergence, PrefilteredOcclusionOfATreeGoesToExactWithTheFootprint) {
  expect_convergence(load_scene("scene:tree?leaves=3000"), "tree");
  expect_convergence(load_scene("scene:forest?trees=9&leaves=500"), "forest");
}

TEST(Convergence, PrefilteredOcclusionOfTheSaplingGoesToExactWithTheFootprint) {
  DAPPLE_SKIP_WITHOUT(shared_scene("sapling_100k.glb"));
  expect_convergence(load_sapling(), "sapling");
}

TEST(Convergence, PrefilteredOcclusionOfTheTexturedPineGoesToExactWithTheFootprint) {
  DAPPLE_SKIP_WITHOUT(shared_scene("smallpine"));
  expect_convergence(load_pine(), "pine");
}

}  // namespace dapple::oracle
