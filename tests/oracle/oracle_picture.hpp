// A small renderer on top of Embree: AO and one rect light, every surface composited, with
// the statistical error of what it says.
#pragma once

#include <vector>

#include "oracle/embree_oracle.hpp"

namespace dapple::oracle {

/// One quantity of a picture, pixel by pixel, top row first.
struct Estimate {
  std::vector<double> pixels;
  std::vector<double> variances;  ///< of `pixels`, as estimated from their samples

  [[nodiscard]] double mean() const;
  [[nodiscard]] double standard_error() const;  ///< of mean()
};

struct Picture {
  Estimate ao;           ///< 1 = unoccluded, and where a camera ray meets nothing
  Estimate light;        ///< irradiance of the light at radiance 1, relative to `brightest`
  double brightest = 0;  ///< largest unoccluded irradiance of a pixel at radiance 1
};

/// `spp` camera rays a pixel through uniformly random places, each with one AO ray and one ray
/// to the rect light. `camera` is a perspective one.
Picture draw(const EmbreeOracle& scene, const Camera& camera, int width, int height, int spp,
             const Light& rect, std::uint64_t seed);

}  // namespace dapple::oracle
