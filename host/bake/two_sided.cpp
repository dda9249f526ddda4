#include "bake/two_sided.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/opacity/connected_vertices.hpp"
#include "bvh/opacity/welded_vertices.hpp"

namespace dapple {
namespace {

/// Small sheets are no longer than this share of the scene's diagonal.
constexpr float kSmallShare = 0.25f;

Box3f box_of(const Mesh& mesh) {
  Box3f box;
  for (const V3f& position : mesh.positions) box.extendBy(position);
  return box;
}

/// The diagonal of the scene's box, in the units of `mesh` where that is placed largest.
float scene_size(const Scene& scene, const Mesh& mesh) {
  std::vector<Box3f> boxes(scene.meshes.size());
  std::transform(scene.meshes.begin(), scene.meshes.end(), boxes.begin(), box_of);
  Box3f world;
  float scale = 0;
  for (const Instance& instance : scene.instances) {
    const Box3f& box = boxes[instance.mesh];
    if (box.isEmpty()) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const V3f local((corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                      (corner & 4 ? box.max : box.min).z);
      world.extendBy(local * instance.to_world);
    }
    if (&scene.meshes[instance.mesh] != &mesh) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const float* row = instance.to_world[axis];
      scale = std::max(scale, V3f(row[0], row[1], row[2]).length());
    }
  }
  return scale > 0 ? world.size().length() / scale : box_of(mesh).size().length();
}

/// Unmarks the triangles of connected sheets that are not small.
void leave_small_sheets(const Mesh& mesh, float scene_size, std::vector<bool>& two_sided) {
  const std::vector<std::uint32_t> welded = welded_vertices(mesh.positions, mesh.indices);
  const auto vertex = [&](std::size_t t, int k) {
    return welded[mesh.indices[3 * t + static_cast<std::size_t>(k)]];
  };
  ConnectedVertices sheets = connect_triangles(
      welded.size(), two_sided.size(), [&](std::size_t t) { return two_sided[t]; }, vertex);
  std::vector<Box3f> boxes(welded.size());
  for (std::uint32_t v = 0; v < welded.size(); ++v)
    boxes[sheets.root(welded[v])].extendBy(mesh.positions[v]);
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    if (boxes[sheets.root(vertex(t, 0))].size().length() > kSmallShare * scene_size)
      two_sided[t] = false;
}

}  // namespace

std::vector<bool> two_sided_triangles(const Scene& scene, const Mesh& mesh, BakeSides sides) {
  const bool chooses = sides == BakeSides::automatic;
  std::vector<bool> two_sided(mesh.primitive_count(), !chooses && sides != BakeSides::front);
  if (!chooses) return two_sided;
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    two_sided[t] = scene.materials[mesh.materials[t]].double_sided;
  if (std::find(two_sided.begin(), two_sided.end(), true) != two_sided.end())
    leave_small_sheets(mesh, scene_size(scene, mesh), two_sided);
  return two_sided;
}

}  // namespace dapple
