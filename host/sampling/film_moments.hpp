// What adaptive sampling reads off the sums of a picture that is being traced: how far pixels'
// samples lie apart, and what they cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/options.hpp"
#include "device/context.hpp"
#include "scene/images/dome_image.hpp"
#include "film/film_sums.hpp"
#include "sampling/sample_cost.hpp"

namespace dapple {

/// Each pixel has whole batches, or none; `width` pixels a row. What it is made from must
/// outlive it.
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

  /// batch_variances() of every pass, those of single batches added, lights relative to their
  /// largest unoccluded irradiance.
  [[nodiscard]] std::vector<std::vector<float>> variances() const;
  /// sample_costs() so far.
  [[nodiscard]] std::vector<float> costs() const;

 private:
  [[nodiscard]] double sum(std::uint32_t plane, std::uint32_t pixel) const {
    return static_cast<double>(sums_[std::size_t{plane} * layout_.pixels + pixel]);
  }
  /// Over a pixel's samples, 0 where there are none.
  [[nodiscard]] double mean(double sum, std::uint32_t pixel) const {
    return samples_[pixel] ? sum / samples_[pixel] : 0.0;
  }
  /// Of one channel itself, of three their luminance.
  [[nodiscard]] double luminance_sum(std::uint32_t first, std::uint32_t channels,
                                     std::uint32_t pixel) const {
    if (channels == 1) return sum(first, pixel);
    return luminance(V3d(sum(first, pixel), sum(first + 1, pixel), sum(first + 2, pixel)));
  }
  [[nodiscard]] std::vector<float> ao_variances() const;
  [[nodiscard]] std::vector<float> light_variances(std::size_t light) const;
  /// Of all pixels, irradiance at radiance 1. `scale`: of the sums; `variances`: batch_variances()
  /// of the irradiance.
  [[nodiscard]] double largest_unoccluded(const LightPlaneRange& planes, double scale,
                                          const std::vector<float>& variances) const;
  /// batch_variances() of a pass whose samples' values have a pixel's `mean`.
  template <class Mean>
  [[nodiscard]] std::vector<float> variances_of(const Mean& mean,
                                                std::uint32_t squares_plane) const;
  [[nodiscard]] std::vector<float> plane(std::uint32_t number, double factor) const;
  /// What `rays` of each hit did, which have planes of visits and tests.
  [[nodiscard]] PassWork work_of(int rays, std::uint32_t visits) const;

  std::span<const std::int64_t> sums_;
  std::span<const float> squares_;
  const FilmLayout& layout_;
  const RenderOptions& options_;
  const std::vector<std::uint32_t>& samples_;
  int width_;
};

}  // namespace dapple
