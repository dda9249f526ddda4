// Pictures of smooth shapes around the origin, for tests of shading: their options, a sun, and the
// values of layers of vectors.
#pragma once

#include <numbers>
#include <string>

#include "dapple/render.hpp"

namespace dapple::test {

inline RenderOptions options_of(Normals normals, Estimator estimator = Estimator::exact) {
  RenderOptions options;
  options.width = 80;
  options.height = 60;
  options.spp = 16;
  options.normals = normals;
  options.estimator = estimator;
  options.look = LookAt{V3f(0, 1, 4), V3f(0, 0, 0), V3f(0, 1, 0)};
  return options;
}

/// A small sun of irradiance 1 across its direction.
inline Light small_sun(const V3f& towards) {
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = -towards.normalized();
  sun.angular_radius = 0.02f;
  sun.radiance = V3f(1 / (std::numbers::pi_v<float> * 4e-4f));
  return sun;
}

inline V3f three(const Film& film, const std::string& layer, std::size_t pixel) {
  return {film.find(layer + ".X")->pixels[pixel], film.find(layer + ".Y")->pixels[pixel],
          film.find(layer + ".Z")->pixels[pixel]};
}

}  // namespace dapple::test
