// Compares bounds, lights and cameras with the range: see numeric_range.hpp.
#include "scene/check/numeric_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dapple/error.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/message.hpp"

namespace dapple {
namespace {

[[noreturn]] void refuse(const Scene& scene, const std::string& what, double value) {
  throw Error(ErrorKind::input,
              fmt::format("{}: {} reaches {:g} m from the origin; dapple renders up to {:g} m: "
                          "scale the scene down or move it to the origin",
                          source_name(scene), what, value, kLargestCoordinate));
}

double reach(const V3f& point) {
  return std::max(
      {std::abs(double{point.x}), std::abs(double{point.y}), std::abs(double{point.z})});
}

/// The comparison is negated, so that a NaN is out of range too.
void check_point(const Scene& scene, const std::string& what, const V3f& point) {
  if (!(reach(point) <= kLargestCoordinate)) refuse(scene, what, reach(point));
}

/// Steps of coordinates that are coarse, as a part of the scene's size: 1 mm of 100 m.
constexpr double kCoarseStep = 1e-5;
/// Meshes of at most so many triangles are merged, wherever they are placed (scene/merge.cpp).
constexpr std::size_t kTinyTriangles = 256;

/// Warns if coordinates within `bounds` have coarse steps.
void warn_of_coarse_steps(const Box3f& bounds, const std::string& what, const char* origin,
                          Scene& scene) {
  const double far = std::max(reach(bounds.min), reach(bounds.max));
  const double step = far * std::numeric_limits<float>::epsilon();
  if (!(step > kCoarseStep * (bounds.max - bounds.min).length())) return;
  scene.warnings.push_back(
      fmt::format("{} lies {:.3g} m from {}, where coordinates have steps of {:.2g} m: "
                  "move it to {}, or smaller details and distances are lost",
                  what, far, origin, step, origin));
}

/// Rays are carried into the space of meshes that are placed several times; others are brought
/// into the world.
void warn_of_far_meshes(Scene& scene) {
  std::vector<std::uint32_t> placements(scene.meshes.size());
  for (const Instance& instance : scene.instances) ++placements[instance.mesh];
  for (std::size_t m = 0; m < placements.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (placements[m] < 2 || mesh.primitive_count() <= kTinyTriangles) continue;
    Box3f bounds;
    for (const V3f& position : mesh.positions) bounds.extendBy(position);
    const std::size_t warnings = scene.warnings.size();
    warn_of_coarse_steps(bounds, element("mesh", m, mesh.name), "its own origin", scene);
    if (scene.warnings.size() > warnings) return;  // of one, as all are of one file
  }
}

}  // namespace

void check_numeric_range(Scene& scene) {
  const Box3f bounds = scene_bounds(scene);
  if (!bounds.isEmpty()) {
    check_point(scene, "its geometry", bounds.min);
    check_point(scene, "its geometry", bounds.max);
    warn_of_coarse_steps(bounds, "the scene", "the origin", scene);
    warn_of_far_meshes(scene);
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
