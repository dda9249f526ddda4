// Random rays through a scene. In: a scene and a seed; out: the same rays in Embree's form and in
// the device's.
#pragma once

#include <cmath>
#include <vector>

#include "dapple/dapple.hpp"
#include "oracle/embree_oracle.hpp"

namespace dapple::oracle {

inline constexpr std::size_t kRays = 100'000;

/// A random point on a surface. Primitives are chosen by number and not by area, so that small ones
/// are tested as often as large ones.
inline V3d random_target(const Scene& scene, Random& random) {
  const auto pick = [&](std::size_t count) {
    return static_cast<std::size_t>(random.real() * static_cast<double>(count));
  };
  const Instance& instance = scene.instances[pick(scene.instances.size())];
  const Mesh& mesh = scene.meshes[instance.mesh];
  if (mesh.has_strands()) {
    const std::uint32_t* end = &mesh.indices[2 * pick(mesh.primitive_count())];
    const double share = random.real();
    const V3d point =
        V3d(mesh.positions[end[0]]) * (1 - share) + V3d(mesh.positions[end[1]]) * share;
    // Anywhere across the strand's thickness, and slightly beyond it.
    return (point + random.direction() * (1.2 * random.real() * mesh.radii[end[0]])) *
           Imath::M44d(instance.to_world);
  }
  const std::uint32_t* corner = &mesh.indices[3 * pick(mesh.primitive_count())];
  const double root = std::sqrt(random.real()), share = random.real();
  const V3d a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]),
      c(mesh.positions[corner[2]]);
  const V3d point = a * (1 - root) + b * (root * share) + c * (root * (1 - share));
  return point * Imath::M44d(instance.to_world);
}

/// Rays from random points in the scene's box, enlarged by a quarter. Three of four rays aim at a
/// surface, one has a random direction. Every second ray ends at a distance, as light rays do.
inline std::vector<Segment> random_segments(const Scene& scene, std::uint64_t seed) {
  Random random(seed);
  const Box3f box = scene_bounds(scene);
  const V3d margin = V3d(box.size()) / 8.0;
  const V3d low = V3d(box.min) - margin, high = V3d(box.max) + margin;
  std::vector<Segment> segments(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    V3d origin;
    for (int k = 0; k < 3; ++k) origin[k] = random.between(low[k], high[k]);
    const V3d way = random_target(scene, random) - origin;
    segments[i].origin = V3f(origin);
    segments[i].direction = V3f(i % 4 == 3 ? random.direction() : way.normalized());
    if (i % 2) segments[i].t_max = static_cast<float>(2 * random.real() * way.length());
  }
  return segments;
}

/// The same rays for the device, with a footprint of `solid_angle` steradians.
inline std::vector<Ray> device_rays(const std::vector<Segment>& segments, float solid_angle) {
  std::vector<Ray> rays;
  for (const Segment& s : segments) {
    Ray ray{};
    for (int k = 0; k < 3; ++k) {
      ray.origin[k] = s.origin[k];
      ray.direction[k] = s.direction[k];
    }
    ray.t_max = s.t_max;
    ray.solid_angle = solid_angle;
    ray.weight = 1;
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace dapple::oracle
