// Samples of lights for Embree's shadow rays. In: a light, a point and a position in the unit
// square. Out: direction, distance and weight. The densities are those of
// kernels/lights, so that the noise is the same.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::bench {

struct LightSample {
  V3f direction;   ///< towards the light, unit
  float distance;  ///< metres
  float weight;    ///< irradiance at radiance 1 is the mean of weight * cosine * transmittance
};

/// Whether LightSampler can sample this light: rects, spheres and suns.
bool can_sample(const Light& light);

/// A light, with what is the same for all points.
class LightSampler {
 public:
  explicit LightSampler(const Light& light);
  /// A sample as seen from `origin`; (x, y) is a point of the unit square.
  [[nodiscard]] LightSample operator()(const V3f& origin, float x, float y) const;

 private:
  [[nodiscard]] LightSample sample_rect(const V3f& origin, float u, float v) const;

  Light light_;
  V3f corner_, x_axis_, y_axis_;  ///< of a rect: world space; unit, along the shorter edge first
  float width_ = 0, length_ = 0;  ///< of a rect: its edges, metres
};

}  // namespace dapple::bench
