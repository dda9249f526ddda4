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

FilmScales scales_of(const View& view, const Box3f& bounds) {
  const V3f eye(view.camera.to_world[3][0], view.camera.to_world[3][1], view.camera.to_world[3][2]);
  Box3f with_eye = bounds;
  with_eye.extendBy(eye);
  return {scale_for(largest_coordinate(bounds)), scale_for((with_eye.max - with_eye.min).length())};
}

}  // namespace

FilmLayout::FilmLayout(const View& view, const RenderOptions& options, const Box3f& bounds,
                       const std::vector<Light>& scene_lights, bool has_normals)
    : FilmLayout(view.pixel_count(), options, scales_of(view, bounds), scene_lights, has_normals) {}

FilmLayout::FilmLayout(std::uint32_t pixel_count, const RenderOptions& options, FilmScales scales,
                       const std::vector<Light>& scene_lights, bool has_normals)
    : pixels(pixel_count), plane_count(kSurfacePlanes) {
  if (options.ao) {
    ao = plane_count;
    plane_count += kAoPlanes;
    squares += 2;
  }
  for (const Light& light : scene_lights) {
    lights.push_back({plane_count, light.kind == LightKind::dome ? 3u : 1u});
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
  light_scale = scale_for(1024.0 * std::numbers::pi);
  position_scale = scales.position;
  depth_scale = scales.depth;
}

}  // namespace dapple
