// Shadow rays to a light for the Embree side: the same densities as kernels/lights/light.cl, so
// that the noise is the same.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::bench {

struct LightSample {
  V3f direction;   ///< towards the light, unit
  float distance;  ///< metres
  float weight;    ///< irradiance at radiance 1 is the mean of weight * cosine * transmittance
};

/// Whether sample_light() knows this light: all but mesh lights.
bool can_sample(const Light& light);

/// From `origin`; (x, y) is a point of the unit square.
LightSample sample_light(const Light& light, const V3f& origin, float x, float y);

}  // namespace dapple::bench
