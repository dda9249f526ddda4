// A tree in the wind. In: a procedural tree or cloud, and a time; out: the scene at that time. The
// stem bends, the boughs swing and the leaves flutter, smoothly in time.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "dapple/scene.hpp"

namespace dapple::motion {

/// Index of the leaves' first vertex. Leaves come last in the mesh, four vertices each.
inline std::size_t first_leaf_vertex(const Scene& scene, const Mesh& mesh) {
  std::size_t first = mesh.positions.size();
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (scene.materials[mesh.materials[t]].name == "leaf")
      first = std::min<std::size_t>(first, mesh.indices[3 * t]);
  }
  return first;
}

/// `p` rotated by `angle` (radians) around the unit vector `axis` through the origin.
inline V3f turned(const V3f& p, const V3f& axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return p * c + axis.cross(p) * s + axis * (axis.dot(p) * (1 - c));
}

/// How far the wind moves the point `p` of a tree, in metres, at `time` seconds. The tree's lowest
/// point is `foot`, and it is `height` metres high.
inline V3f displacement(const V3f& p, const V3f& foot, float height, float wind, float time) {
  const V3f q = (p - foot) / height;
  const float bend = wind * 0.06f * height * q.y * q.y;
  const float swing = wind * 0.012f * height * q.y;
  return V3f(bend * (1 + std::sin(1.7f * time)) + swing * std::sin(4.1f * time + 9 * q.z + 5 * q.y),
             -swing * std::sin(3.3f * time + 7 * q.x + 3 * q.z),
             0.4f * bend * std::sin(1.1f * time) + swing * std::sin(3.7f * time + 8 * q.x));
}

/// The scene's first mesh, a tree or cloud, at `time` seconds. `wind` 1: a breeze in which the top
/// moves by an eighth of the height and leaves turn by up to 17 degrees.
inline Scene swayed(const Scene& still, float time, float wind = 1) {
  Scene scene = still;
  Mesh& mesh = scene.meshes[0];
  Box3f box;
  for (const V3f& p : mesh.positions) box.extendBy(p);
  const V3f foot((box.min.x + box.max.x) / 2, box.min.y, (box.min.z + box.max.z) / 2);
  const float height = box.max.y - box.min.y;
  const std::size_t leaves = first_leaf_vertex(scene, mesh);
  for (std::size_t v = 0; v < leaves; ++v)
    mesh.positions[v] += displacement(mesh.positions[v], foot, height, wind, time);
  for (std::size_t v = leaves; v + 4 <= mesh.positions.size(); v += 4) {
    V3f* corner = &mesh.positions[v];
    const V3f base = corner[0], axis = (corner[2] - base).normalized();
    const float angle = 0.3f * wind * std::sin(6 * time + static_cast<float>(v % 97));
    const V3f moved = displacement(base, foot, height, wind, time);
    for (int k = 0; k < 4; ++k) corner[k] = base + moved + turned(corner[k] - base, axis, angle);
  }
  return scene;
}

}  // namespace dapple::motion
