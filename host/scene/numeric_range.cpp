// Compares bounds, lights and cameras with the range: see numeric_range.hpp.
#include "scene/numeric_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

[[noreturn]] void refuse(const Scene& scene, const std::string& what, double value) {
  throw Error(ErrorKind::input,
              fmt::format("{}: {} reaches {:g} m from the origin; dapple renders up to {:g} m: "
                          "scale the scene down or move it to the origin",
                          scene.source, what, value, kLargestCoordinate));
}

double reach(const V3f& point) {
  return std::max(
      {std::abs(double{point.x}), std::abs(double{point.y}), std::abs(double{point.z})});
}

/// The comparison is negated, so that a NaN is out of range too.
void check_point(const Scene& scene, const std::string& what, const V3f& point) {
  if (!(reach(point) <= kLargestCoordinate)) refuse(scene, what, reach(point));
}

}  // namespace

void check_numeric_range(const Scene& scene) {
  const Box3f bounds = scene_bounds(scene);
  if (!bounds.isEmpty()) {
    check_point(scene, "its geometry", bounds.min);
    check_point(scene, "its geometry", bounds.max);
  }
  for (const Light& light : scene.lights) {
    if (light.kind == LightKind::rect || light.kind == LightKind::disk ||
        light.kind == LightKind::sphere) {
      check_point(scene, fmt::format("light \"{:.100}\"", light.name), light.position);
    }
  }
  for (const Camera& camera : scene.cameras) {
    const M44f& m = camera.to_world;
    check_point(scene, fmt::format("camera \"{:.100}\"", camera.name), {m[3][0], m[3][1], m[3][2]});
  }
}

}  // namespace dapple
