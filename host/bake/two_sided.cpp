#include "bake/two_sided.hpp"

#include <ImathBoxAlgo.h>

#include <algorithm>

#include "bvh/opacity/welded_vertices.hpp"
#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

/// Small sheets are no longer than this share of the scene's diagonal.
constexpr float kSmallShare = 0.25f;

Box3f box_of(const Mesh& mesh) {
  Box3f box;
  for (const V3f& position : mesh.positions) box.extendBy(position);
  return box;
}

float largest_scale(const M44f& matrix) {
  float scale = 0;
  for (int axis = 0; axis < 3; ++axis)
    scale = std::max(scale, V3f(matrix[axis][0], matrix[axis][1], matrix[axis][2]).length());
  return scale;
}

/// By mesh: the largest scale of its instances; 0 if it has none.
std::vector<float> largest_scales(const Scene& scene) {
  std::vector<float> scales(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    scales[instance.mesh] = std::max(scales[instance.mesh], largest_scale(instance.to_world));
  return scales;
}

/// The box of the instances' boxes.
Box3f world_box(const Scene& scene, const std::vector<Box3f>& of_mesh) {
  Box3f world;
  for (const Instance& instance : scene.instances)
    if (!of_mesh[instance.mesh].isEmpty())
      world.extendBy(Imath::transform(of_mesh[instance.mesh], instance.to_world));
  return world;
}

/// Unmarks the triangles of connected sheets that are not small.
void leave_small_sheets(const Mesh& mesh, float longest, std::vector<bool>& two_sided) {
  const std::vector<std::uint32_t> welded = welded_vertices(mesh.positions, mesh.indices);
  const auto vertex = [&](std::size_t t, int k) {
    return welded[mesh.indices[3 * t + static_cast<std::size_t>(k)]];
  };
  DisjointSets sheets = connect_triangles(
      welded.size(), two_sided.size(), [&](std::size_t t) { return two_sided[t]; }, vertex);
  std::vector<Box3f> boxes(welded.size());
  for (std::uint32_t v = 0; v < welded.size(); ++v)
    boxes[sheets.root(welded[v])].extendBy(mesh.positions[v]);
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    if (boxes[sheets.root(vertex(t, 0))].size().length() > longest) two_sided[t] = false;
}

}  // namespace

TwoSided::TwoSided(const Scene& scene, BakeSides sides) : scene_(scene), sides_(sides) {
  if (sides != BakeSides::automatic) return;
  std::vector<Box3f> boxes(scene.meshes.size());
  std::transform(scene.meshes.begin(), scene.meshes.end(), boxes.begin(), box_of);
  const float scene_size = world_box(scene, boxes).size().length();
  longest_ = largest_scales(scene);
  for (std::size_t m = 0; m < boxes.size(); ++m)
    longest_[m] =
        kSmallShare * (longest_[m] > 0 ? scene_size / longest_[m] : boxes[m].size().length());
}

std::vector<bool> TwoSided::triangles(const Mesh& mesh) const {
  const bool chooses = sides_ == BakeSides::automatic && !mesh.has_strands();
  std::vector<bool> two_sided(mesh.primitive_count(),
                              sides_ == BakeSides::max || sides_ == BakeSides::mean);
  if (!chooses) return two_sided;
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    two_sided[t] = scene_.materials[mesh.materials[t]].double_sided;
  const auto index = static_cast<std::size_t>(&mesh - scene_.meshes.data());
  if (std::find(two_sided.begin(), two_sided.end(), true) != two_sided.end())
    leave_small_sheets(mesh, longest_[index], two_sided);
  return two_sided;
}

}  // namespace dapple
