#include "film/sums/film_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "film/light_layers.hpp"
#include "scene/images/color.hpp"

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

/// Distances from the light's position to the nearest and to the farthest point of `bounds`.
struct Distances {
  double nearest, farthest;
};

Distances distances_from(const LightRecord& light, const Box3f& bounds) {
  double near = 0, far = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = light.position[axis];
    const double below = bounds.min[axis] - at, above = at - bounds.max[axis];
    const double beside = std::max({below, above, 0.0});
    near += beside * beside;
    far += std::max(below * below, above * above);
  }
  return {std::sqrt(near), std::sqrt(far)};
}

/// The irradiance, at radiance 1, of surfaces that face a light at the farthest and at the nearest
/// point of the scene. Right to a factor of two; samples near mesh lights may exceed `largest`.
struct Irradiance {
  double smallest, largest;
};

/// A sphere or a flat light of this area that is `distances` away.
Irradiance irradiance_of(double area, const Distances& distances) {
  constexpr double kNearest = 1e-3;  // metres
  const double nearest =
      std::max({distances.nearest, std::sqrt(area / std::numbers::pi), kNearest});
  return {area / (distances.farthest * distances.farthest), area / (nearest * nearest)};
}

Irradiance irradiance_of(const LightRecord& light, const Box3f& bounds) {
  constexpr double kPi = std::numbers::pi;
  switch (light.kind) {
    case DAPPLE_LIGHT_DOME:
      return {1, kPi};
    case DAPPLE_LIGHT_SUN:
      return {2 * kPi * light.one_minus_cos, 2 * kPi * light.one_minus_cos};
    case DAPPLE_LIGHT_SPHERE:
      return irradiance_of(kPi * light.radius * light.radius, distances_from(light, bounds));
    case DAPPLE_LIGHT_MESH:
      return irradiance_of(light.area, {0, (bounds.max - bounds.min).length()});
    default:
      return irradiance_of(light.area, distances_from(light, bounds));
  }
}

/// A light that has shrunk to nothing has none.
Irradiance of_both(const Irradiance& a, const Irradiance& b) {
  if (!(a.smallest > 0)) return b;
  if (!(b.smallest > 0)) return a;
  return {std::min(a.smallest, b.smallest), std::max(a.largest, b.largest)};
}

/// A power of two for which the smallest irradiance has 28 bits, if then the largest has 35 at
/// most: the sum of 2^24 rays of it stays below the limit. Lights that are so small against the
/// scene that 12 bits ask for more may have up to 43, for 2^16 rays.
float light_scale(const Irradiance& irradiance) {
  constexpr int kSmallestBits = 28, kLargestBits = 35, kFewBits = 12, kManyBits = 43;
  constexpr int kLeast = 26, kMost = 100;
  int exponent = kLeast;
  if (irradiance.smallest > 0 && std::isfinite(irradiance.largest)) {
    const int smallest = std::ilogb(irradiance.smallest), largest = std::ilogb(irradiance.largest);
    exponent = std::clamp(std::max(std::min(kSmallestBits - smallest, kLargestBits - largest),
                                   std::min(kFewBits - smallest, kManyBits - largest)),
                          kLeast, kMost);
  }
  return static_cast<float>(std::ldexp(1.0, exponent));
}

}  // namespace

FilmScales film_scales(const View& view, const Box3f& bounds, std::span<const LightRecord> lights,
                       std::span<const LightRecord> at_others) {
  const V3f eye(view.camera.to_world[3][0], view.camera.to_world[3][1], view.camera.to_world[3][2]);
  Box3f with_eye = bounds;
  with_eye.extendBy(eye);
  FilmScales scales{
      scale_for(largest_coordinate(bounds)), scale_for((with_eye.max - with_eye.min).length()), {}};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    Irradiance all = irradiance_of(lights[i], bounds);
    for (std::size_t k = i; k < at_others.size(); k += lights.size())
      all = of_both(all, irradiance_of(at_others[k], bounds));
    scales.lights.push_back(light_scale(all));
  }
  return scales;
}

FilmLayout::FilmLayout(const PixelRect& crop, const RenderOptions& options,
                       const FilmScales& scales, const std::vector<Light>& scene_lights,
                       bool has_normals)
    : width(static_cast<std::uint32_t>(crop.width())),
      pixels(width * static_cast<std::uint32_t>(crop.height())),
      plane_count(DAPPLE_SURFACE_PLANES) {
  const std::uint32_t reflected = options.albedo ? DAPPLE_REFLECTED_PLANES : 0;
  if (options.ao) {
    ao = plane_count;
    plane_count += DAPPLE_AO_PLANES + reflected;
    squares += 2;
  }
  for (const Light& light : scene_lights) {
    lights.push_back({plane_count, light.kind == LightKind::dome ? DAPPLE_DOME_CHANNELS : 1u,
                      scales.lights.at(lights.size())});
    plane_count = lights.back().reflected() + reflected;
    squares += 2;
  }
  for (LightLayer& layer : light_layers(scene_lights)) {
    if (layer.lights.size() < 2) continue;
    std::vector<double> luminances;
    for (const std::size_t l : layer.lights)
      luminances.push_back(luminance(scene_lights[l].radiance));
    groups.push_back({std::move(layer.lights), std::move(luminances)});
  }
  if (options.back) {
    back_samples = plane_count;
    plane_count += DAPPLE_BACK_PLANES;
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
    plane_count += DAPPLE_NORMAL_PLANES;
  }
  if (options.albedo) {
    albedo = plane_count;
    plane_count += DAPPLE_ALBEDO_PLANES;
  }
  unit_scale = scale_for(1.0);
  position_scale = scales.position;
  depth_scale = scales.depth;
}

}  // namespace dapple
