#include "film/film_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

/// Bits of one sample's largest value in fixed point: the sum of 2^24 samples must fit 63 bits.
constexpr int kSampleBits = 38;

float scale_for(double largest) {
  const int exponent =
      std::isfinite(largest) && largest > 0 ? static_cast<int>(std::ceil(std::log2(largest))) : 0;
  return static_cast<float>(std::ldexp(1.0, kSampleBits - exponent));
}

double largest_coordinate(const Box3f& box) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    largest =
        std::max({largest, std::fabs(double{box.min[axis]}), std::fabs(double{box.max[axis]})});
  }
  return largest;
}

/// Distance from the light's position to the farthest point of `bounds`.
double farthest(const LightRecord& light, const Box3f& bounds) {
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = light.position[axis];
    const double far = std::max(std::fabs(at - bounds.min[axis]), std::fabs(at - bounds.max[axis]));
    square += far * far;
  }
  return std::sqrt(square);
}

/// What a light of radiance 1 gives to a surface that faces it.
struct Irradiance {
  double smallest;  ///< at the farthest point of the scene
  double largest;   ///< samples of flat lights, which are chosen by area, may exceed it
};

Irradiance irradiance_of(const LightRecord& light, const Box3f& bounds) {
  constexpr double kPi = std::numbers::pi, kLargestFlat = 1024 * kPi;
  switch (light.kind) {
    case DAPPLE_LIGHT_DOME:
      return {1, kLargestFlat};
    case DAPPLE_LIGHT_SUN:
      return {2 * kPi * light.one_minus_cos, 2 * kPi * light.one_minus_cos};
    case DAPPLE_LIGHT_SPHERE: {
      const double sine = light.radius / farthest(light, bounds);
      return {kPi * sine * sine, 4 * kPi};
    }
    case DAPPLE_LIGHT_MESH:
      return {light.area / double{(bounds.max - bounds.min).length2()}, kLargestFlat};
    default: {
      const double distance = farthest(light, bounds);
      return {light.area / (distance * distance), kLargestFlat};
    }
  }
}

float light_scale(const LightRecord& light, const Box3f& bounds) {
  constexpr int kSmallestBits = 12, kMaxExponent = 100;
  const Irradiance irradiance = irradiance_of(light, bounds);
  const float for_largest = scale_for(irradiance.largest);
  if (!std::isfinite(irradiance.smallest) || !(irradiance.smallest > 0)) return for_largest;
  const int exponent = kSmallestBits - static_cast<int>(std::floor(std::log2(irradiance.smallest)));
  return std::max(for_largest,
                  static_cast<float>(std::ldexp(1.0, std::min(exponent, kMaxExponent))));
}

}  // namespace

FilmScales film_scales(const View& view, const Box3f& bounds, std::span<const LightRecord> lights) {
  const V3f eye(view.camera.to_world[3][0], view.camera.to_world[3][1], view.camera.to_world[3][2]);
  Box3f with_eye = bounds;
  with_eye.extendBy(eye);
  FilmScales scales{
      scale_for(largest_coordinate(bounds)), scale_for((with_eye.max - with_eye.min).length()), {}};
  for (const LightRecord& light : lights) scales.lights.push_back(light_scale(light, bounds));
  return scales;
}

FilmLayout::FilmLayout(const PixelRect& crop, const RenderOptions& options,
                       const FilmScales& scales, const std::vector<Light>& scene_lights,
                       bool has_normals)
    : width(static_cast<std::uint32_t>(crop.width())),
      pixels(width * static_cast<std::uint32_t>(crop.height())),
      plane_count(kSurfacePlanes) {
  if (options.ao) {
    ao = plane_count;
    plane_count += kAoPlanes;
    squares += 2;
  }
  for (const Light& light : scene_lights) {
    lights.push_back(
        {plane_count, light.kind == LightKind::dome ? 3u : 1u, scales.lights.at(lights.size())});
    plane_count += lights.back().count();
    squares += 2;
  }
  if (options.back) {
    back_samples = plane_count;
    plane_count += 2;
    if (options.ao) {
      back_ao = plane_count;
      plane_count += 1;
    }
    for (const LightPlaneRange& light : lights) {
      back_lights.push_back(plane_count);
      plane_count += light.channels;
    }
  }
  if (has_normals) {
    normals = plane_count;
    plane_count += kNormalPlanes;
  }
  if (options.albedo) {
    albedo = plane_count;
    plane_count += kAlbedoPlanes;
  }
  unit_scale = scale_for(1.0);
  position_scale = scales.position;
  depth_scale = scales.depth;
}

}  // namespace dapple
