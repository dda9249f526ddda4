#include "accuracy/image_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "accuracy/pixel_statistics.hpp"

namespace dapple::bench {
namespace {

/// Sums over pictures of one footprint and over their differences from exact pictures of the same
/// seeds. Equal seeds give equal camera samples and directions, so that the differences come almost
/// only from the footprint.
class FootprintSums {
 public:
  FootprintSums(float footprint, const Picture& shape) : footprint_(footprint) {
    for (const PicturePass& pass : shape.passes) {
      names_.push_back(pass.name);
      values_.emplace_back(shape.visible);
      differences_.emplace_back(shape.visible);
    }
  }

  [[nodiscard]] float footprint() const { return footprint_; }

  void add(const Picture& picture, const Picture& exact) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::vector<double>& pixels = picture.passes[i].pixels;
      std::vector<double> difference(pixels.size());
      std::transform(pixels.begin(), pixels.end(), exact.passes[i].pixels.begin(),
                     difference.begin(), std::minus<>());
      values_[i].add(pixels);
      differences_[i].add(difference);
    }
    ao_seconds_.push_back(picture.ao_seconds);
    light_seconds_.push_back(picture.light_seconds);
    trace_seconds_.push_back(picture.trace_seconds);
  }

  [[nodiscard]] ImageAccuracyRow row() const {
    ImageAccuracyRow row;
    row.footprint = footprint_;
    row.trace_seconds = median(trace_seconds_);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      ImageError error;
      error.pass = names_[i];
      error.bias = differences_[i].mean();
      // The estimate is noisy, but the RMSE is never below the bias.
      error.converged_rmse = std::max(differences_[i].converged_rms(), std::fabs(error.bias));
      error.noise = values_[i].noise();
      error.noise_of_mean = values_[i].noise_of_mean();
      error.seconds = median(names_[i] == "ao" ? ao_seconds_ : light_seconds_);
      row.passes.push_back(error);
    }
    return row;
  }

 private:
  float footprint_;
  std::vector<std::string> names_;
  std::vector<PixelStatistics> values_, differences_;
  std::vector<double> ao_seconds_, light_seconds_, trace_seconds_;
};

/// `options` with this seed and footprint; footprint 0: exact.
RenderOptions variant(RenderOptions options, float footprint, int seed) {
  options.estimator = footprint > 0 ? Estimator::prefiltered : Estimator::exact;
  options.footprint = footprint;
  options.seed = static_cast<std::uint32_t>(seed);
  return options;
}

}  // namespace

std::vector<ImageAccuracyRow> measure_images(PictureScene& scene,
                                             const ImageAccuracyOptions& options,
                                             const std::function<void(double)>& progress) {
  // An additional picture determines which pixels count and the largest irradiance of each light.
  const Picture shape = scene.render(variant(options.render, 0, options.seeds));
  scene.set_largest(shape.largest);
  std::vector<FootprintSums> sums;
  for (const float footprint : options.footprints) sums.emplace_back(footprint, shape);
  sums.emplace_back(0.0f, shape);
  // Seeds are the outer loop, so that changes of the machine's speed affect all footprints equally.
  for (int seed = 0; seed < options.seeds; ++seed) {
    const Picture exact = scene.render(variant(options.render, 0, seed));
    for (FootprintSums& one : sums) {
      if (one.footprint() > 0) {
        one.add(scene.render(variant(options.render, one.footprint(), seed)), exact);
      } else {
        one.add(exact, exact);
      }
    }
    if (progress) progress((seed + 1.0) / options.seeds);
  }
  std::vector<ImageAccuracyRow> rows;
  for (const FootprintSums& one : sums) rows.push_back(one.row());
  return rows;
}

}  // namespace dapple::bench
