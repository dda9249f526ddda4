// A small renderer on top of Embree. In: a scene, a camera, one rect light; out: AO and irradiance
// of each pixel, with an estimate of their statistical error.
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
  Estimate ao;           ///< 1 = unoccluded, also where a camera ray hits nothing
  Estimate light;        ///< irradiance of the light at radiance 1, relative to `brightest`
  double brightest = 0;  ///< the largest unoccluded irradiance of any pixel at radiance 1
};

/// Traces `spp` camera rays a pixel through uniformly random points of it, and from each hit one AO
/// ray and one ray to the rect light. `camera` must be a perspective camera.
Picture draw(const EmbreeOracle& scene, const Camera& camera, int width, int height, int spp,
             const Light& rect, std::uint64_t seed);

}  // namespace dapple::oracle
