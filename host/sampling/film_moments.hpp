// Reads the variances of pixels from the film of a picture that is being traced, for adaptive
// sampling and error layers. In: sums and squares. Out: variances by pass and pixel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/options.hpp"
#include "device/context.hpp"
#include "film/sums/film_sums.hpp"
#include "sampling/batch_variance.hpp"
#include "scene/images/color.hpp"

namespace dapple {

/// Each pixel has two sample batches or more, or no samples. The arguments of the constructor must
/// outlive the object.
class FilmMoments {
 public:
  FilmMoments(const HostView& sums, const HostView& squares, const FilmLayout& layout,
              const RenderOptions& options, const std::vector<std::uint32_t>& samples, int width)
      : sums_(sums.values<std::int64_t>()),
        squares_(squares.values<float>()),
        layout_(layout),
        options_(options),
        samples_(samples),
        width_(width) {}

  /// batch_variances() of every pass. Those of lights are relative to the square of the largest
  /// unoccluded irradiance.
  [[nodiscard]] std::vector<std::vector<float>> variances() const;

  /// What the errors of every pass are relative to: 1 for AO, of lights the largest unoccluded
  /// irradiance at radiance 1. Then the largest of each of FilmLayout::groups, at its radiances. 0
  /// where all is dark: then errors and biases are absolute.
  [[nodiscard]] std::vector<double> largest_values() const;

 private:
  [[nodiscard]] double sum(std::uint32_t plane, std::uint32_t pixel) const {
    return static_cast<double>(sums_[std::size_t{plane} * layout_.pixels + pixel]);
  }
  /// `sum` over the pixel's number of samples; 0 if it has none.
  [[nodiscard]] double mean(double sum, std::uint32_t pixel) const {
    return samples_[pixel] ? sum / samples_[pixel] : 0.0;
  }
  /// The sum of a plane, or the luminance of three.
  [[nodiscard]] double luminance_sum(std::uint32_t first, std::uint32_t channels,
                                     std::uint32_t pixel) const {
    if (channels == 1) return sum(first, pixel);
    return luminance(V3d(sum(first, pixel), sum(first + 1, pixel), sum(first + 2, pixel)));
  }
  [[nodiscard]] std::vector<float> ao_variances() const;

  /// `scale`: of the sums; `squares`: the first plane of squares.
  struct LightPass {
    const LightPlaneRange& planes;
    double scale;
    std::uint32_t squares;
  };
  [[nodiscard]] LightPass light_pass(std::size_t light) const;
  [[nodiscard]] BatchMoments light_moments(const LightPass& pass, std::size_t pixel) const;
  /// batch_variances() of a light's irradiance at one pixel.
  [[nodiscard]] float variance_at(const LightPass& pass, std::size_t pixel) const;
  /// batch_variances() of a light's irradiance, and its largest unoccluded irradiance.
  struct LightVariances {
    std::vector<float> absolute;
    double largest = 0;
  };
  [[nodiscard]] LightVariances light_variances(std::size_t light) const;
  /// The largest unoccluded irradiance of all pixels. `variance`: returns variance_at() of a pixel;
  /// it is called for few of them.
  template <class Variance>
  [[nodiscard]] double largest_unoccluded(const LightPass& pass, const Variance& variance) const;
  /// Of the lights of a group together. `largest`: by pass.
  [[nodiscard]] double largest_unoccluded(const LightGroup& group,
                                          const std::vector<double>& largest) const;
  /// A pixel's batches in a pass. `mean`: returns the mean of a pixel's samples.
  template <class Mean>
  [[nodiscard]] BatchMoments moments(const Mean& mean, std::uint32_t squares_plane,
                                     std::size_t pixel) const;

  std::span<const std::int64_t> sums_;
  std::span<const float> squares_;
  const FilmLayout& layout_;
  const RenderOptions& options_;
  const std::vector<std::uint32_t>& samples_;
  int width_;
};

}  // namespace dapple
