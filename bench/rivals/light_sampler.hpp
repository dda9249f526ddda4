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

/// Whether sample_light() can sample this light: rects, spheres and suns.
bool can_sample(const Light& light);

/// A sample as seen from `origin`; (x, y) is a point of the unit square.
LightSample sample_light(const Light& light, const V3f& origin, float x, float y);

}  // namespace dapple::bench
