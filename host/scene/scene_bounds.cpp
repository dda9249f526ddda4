// Computes the bounds of a scene. In: meshes and instances; out: a box. Vertices that
// no triangle or segment of a strand uses are ignored.
#include <Imath/ImathBoxAlgo.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/check/invertible.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/checked_bounds.hpp"
#include "scene/ground.hpp"

namespace dapple {
namespace {

/// How far strands extend beyond their vertices after `transform`. The largest radius is multiplied
/// by the root mean square of the three axes' scales.
float strand_reach(const Mesh& mesh, const M44f& transform) {
  if (!mesh.has_strands()) return 0;
  float radius = 0;
  for (const std::uint32_t index : mesh.indices) radius = std::max(radius, mesh.radii[index]);
  float square = 0;
  for (int row = 0; row < 3; ++row) {
    square += V3f(transform[row][0], transform[row][1], transform[row][2]).length2();
  }
  return radius * std::sqrt(square / 3);
}

// Minima and maxima do not depend on the order of the vertices, so several threads can work on
// them.
Box3f mesh_bounds(const Mesh& mesh, const M44f& transform) {
  using Range = tbb::blocked_range<std::size_t>;
  Box3f bounds = tbb::parallel_reduce(
      Range(0, mesh.indices.size(), 16384), Box3f{},
      [&](const Range& range, Box3f box) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          box.extendBy(mesh.positions[mesh.indices[i]] * transform);
        }
        return box;
      },
      [](Box3f a, const Box3f& b) {
        a.extendBy(b);
        return a;
      });
  if (bounds.isEmpty()) return bounds;
  const V3f reach(strand_reach(mesh, transform));
  bounds.min -= reach;
  bounds.max += reach;
  return bounds;
}

/// Whether it is not scaled to nothing. Most determinants tell that at once.
bool is_placed(const Instance& instance) {
  return instance.to_world.determinant() != 0 || is_invertible(instance.to_world);
}

}  // namespace

Box3f scene_bounds(const Scene& scene, const M44f& transform) {
  check_geometry(scene);
  return checked_bounds(scene, transform);
}

Box3f checked_bounds(const Scene& scene, const M44f& transform) {
  std::vector<std::uint32_t> instance_counts(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances)
    if (is_placed(instance)) ++instance_counts[instance.mesh];

  std::vector<Box3f> object_bounds(scene.meshes.size());
  Box3f bounds;
  for (const Instance& instance : scene.instances) {
    if (!is_placed(instance)) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (instance_counts[instance.mesh] == 1) {
      bounds.extendBy(mesh_bounds(mesh, instance.to_world * transform));
      continue;
    }
    // A mesh with several instances is visited once, because a forest has too many triangles. The
    // box around its transformed object-space box is a little larger than needed.
    Box3f& box = object_bounds[instance.mesh];
    if (box.isEmpty()) box = mesh_bounds(mesh, M44f{});
    if (!box.isEmpty()) bounds.extendBy(Imath::transform(box, instance.to_world * transform));
  }
  return bounds;
}

Box3f bounds_to_stand_on(const Scene& scene) {
  constexpr std::size_t kMostVertices = 1u << 27;
  Box3f bounds = scene_bounds(scene);
  std::vector<Box3f> of_mesh;
  for (const Mesh& mesh : scene.meshes) of_mesh.push_back(mesh_bounds(mesh, M44f{}));
  std::vector<std::pair<float, const Instance*>> by_height;  // of their boxes
  for (const Instance& instance : scene.instances)
    if (is_placed(instance) && !of_mesh[instance.mesh].isEmpty())
      by_height.emplace_back(Imath::transform(of_mesh[instance.mesh], instance.to_world).min.y,
                             &instance);
  std::sort(by_height.begin(), by_height.end());
  float lowest = std::numeric_limits<float>::infinity();
  std::size_t visited = 0;
  for (const auto& [height, instance] : by_height) {
    if (height >= lowest) break;
    const Mesh& mesh = scene.meshes[instance->mesh];
    visited += mesh.indices.size();
    lowest = std::min(
        lowest, visited < kMostVertices ? mesh_bounds(mesh, instance->to_world).min.y : height);
  }
  if (std::isfinite(lowest)) bounds.min.y = lowest;
  return bounds;
}

}  // namespace dapple
