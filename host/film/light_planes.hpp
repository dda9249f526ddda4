// What the lights of a picture give its pixels. In: sums of the film. Out: irradiances in linear
// RGB, with the lights' radiances in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/render.hpp"
#include "film/sums/film_sums.hpp"
#include "film/sums/sum_values.hpp"
#include "film/traced_picture.hpp"

namespace dapple {

/// The arguments of the constructor must outlive the object.
class LightPlanes {
 public:
  LightPlanes(const Sums& sums, const TracedPicture& picture, const FilmLayout& layout,
              const RenderOptions& options, const std::vector<Light>& lights);

  /// Irradiance from these lights, W/m², premultiplied by alpha.
  [[nodiscard]] V3d sum(const std::vector<std::size_t>& lights, std::uint32_t pixel) const;
  /// The mean over samples of the same times their albedo; for layouts with albedo.
  [[nodiscard]] V3d reflected(const std::vector<std::size_t>& lights, std::uint32_t pixel) const;
  /// Irradiance of the other side of the surfaces.
  [[nodiscard]] V3d back(const std::vector<std::size_t>& lights, std::uint32_t pixel) const;
  /// The pixel whose sums of backs are this one's.
  [[nodiscard]] std::uint32_t back_source(std::uint32_t pixel) const {
    return backs_.empty() ? pixel : backs_[pixel];
  }
  /// The irradiance of all lights without occlusion that `share` of the pixels do not exceed, in
  /// the channel in which it is largest. Only those pixels count whose surfaces face a light; 0 if
  /// none do.
  [[nodiscard]] double unoccluded_percentile(double share) const;

 private:
  /// Planes of one light: one for all channels, or three.
  struct Range {
    std::size_t light;
    std::uint32_t first, channels;
  };
  [[nodiscard]] V3d of_planes(const Range& range, std::uint32_t pixel, double samples) const;

  const Sums& sums_;
  const TracedPicture& picture_;
  const FilmLayout& layout_;
  const std::vector<Light>& lights_;
  std::vector<std::uint32_t> backs_;
  double inverse_rays_;
};

}  // namespace dapple
