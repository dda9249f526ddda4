#include "paper/variants.hpp"

#include <algorithm>
#include <cmath>

#include "accuracy/pixel_statistics.hpp"

namespace dapple::bench {
namespace {

constexpr int kRayCounts[] = {4, 9, 25};
constexpr int kMaxRays = 25;

RenderOptions with(RenderOptions options, const PaperVariant& variant, int seed) {
  options.estimator = variant.estimator;
  options.footprint = variant.footprint;
  options.ao_rays = options.light_rays = variant.rays;
  options.seed = static_cast<std::uint32_t>(seed);
  return options;
}

/// Means of the passes 0 (AO) and 1 (the light) over several pictures, and the variances of these
/// means.
struct Reference {
  std::vector<double> pixels[2];
  double variance[2] = {0, 0};
};

Reference make_reference(PictureScene& scene, const RenderOptions& options, int pictures,
                         const Picture& shape) {
  const PaperVariant exact{"", Estimator::exact, kMaxRays, 0.0f};
  Reference reference;
  std::vector<PixelStatistics> statistics(2, PixelStatistics(shape.visible));
  for (auto& pixels : reference.pixels) pixels.resize(shape.visible.size());
  for (int i = 0; i < pictures; ++i) {
    const Picture picture = scene.render(with(options, exact, 1'000'000 + i));
    for (std::size_t pass = 0; pass < 2; ++pass) {
      statistics[pass].add(picture.passes[pass].pixels);
      for (std::size_t p = 0; p < shape.visible.size(); ++p)
        reference.pixels[pass][p] += picture.passes[pass].pixels[p] / pictures;
    }
  }
  for (std::size_t pass = 0; pass < 2; ++pass)
    reference.variance[pass] =
        statistics[pass].noise() * statistics[pass].noise() / static_cast<double>(pictures);
  return reference;
}

/// Sums over the pictures of one variant.
class VariantSums {
 public:
  VariantSums(PaperVariant variant, const Picture& shape)
      : variant_(std::move(variant)),
        values_(2, PixelStatistics(shape.visible)),
        errors_(values_) {}

  void render(PictureScene& scene, const RenderOptions& options, int seed,
              const Reference& reference) {
    const Picture picture = scene.render(with(options, variant_, seed));
    for (std::size_t pass = 0; pass < 2; ++pass) {
      std::vector<double> error = picture.passes[pass].pixels;
      for (std::size_t p = 0; p < error.size(); ++p) error[p] -= reference.pixels[pass][p];
      values_[pass].add(picture.passes[pass].pixels);
      errors_[pass].add(error);
    }
    seconds_[0].push_back(picture.ao_seconds);
    seconds_[1].push_back(picture.light_seconds);
  }

  [[nodiscard]] PaperRow row(const Reference& reference) const {
    return {variant_, figures(0, reference), figures(1, reference)};
  }

 private:
  [[nodiscard]] PaperFigures figures(std::size_t pass, const Reference& reference) const {
    const double rms = errors_[pass].rms();
    return {median(seconds_[pass]), values_[pass].noise(),
            std::sqrt(std::max(0.0, rms * rms - reference.variance[pass]))};
  }

  PaperVariant variant_;
  std::vector<PixelStatistics> values_, errors_;
  std::vector<double> seconds_[2];
};

}  // namespace

std::vector<PaperVariant> paper_variants(int primary_samples) {
  std::vector<PaperVariant> variants;
  const auto add = [&](const char* name, Estimator estimator, float footprint) {
    for (const int rays : kRayCounts) variants.push_back({name, estimator, rays, footprint});
  };
  add("exact", Estimator::exact, 0.0f);
  add("prefiltered", Estimator::prefiltered, kDefaultFootprint);
  add("prefiltered, n = rays", Estimator::prefiltered, static_cast<float>(primary_samples));
  return variants;
}

std::vector<PaperRow> measure_paper(PictureScene& scene, const RenderOptions& options,
                                    int repeats) {
  const PaperVariant exact{"", Estimator::exact, kMaxRays, 0.0f};
  const Picture shape = scene.render(with(options, exact, 999'999));
  scene.set_largest(shape.largest);
  const Reference reference = make_reference(scene, options, repeats, shape);
  std::vector<VariantSums> sums;
  for (const PaperVariant& variant : paper_variants(options.spp)) sums.emplace_back(variant, shape);
  for (int seed = 0; seed < repeats; ++seed) {
    for (VariantSums& one : sums) one.render(scene, options, seed, reference);
  }
  std::vector<PaperRow> rows;
  for (const VariantSums& one : sums) rows.push_back(one.row(reference));
  return rows;
}

}  // namespace dapple::bench
