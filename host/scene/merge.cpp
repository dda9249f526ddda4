// Merges meshes with one instance, and tiny meshes, into two world-space meshes, one of triangles
// and one of strands. Drops what no ray can hit. In: a scene as it was read; out: the same scene
// with fewer meshes, and warnings.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/check/invertible.hpp"
#include "scene/check/numeric_range.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/check/triangle_cleanup.hpp"
#include "scene/frame_merge.hpp"

namespace dapple {
namespace {

constexpr std::size_t kTinyTriangles = 256;        // a mesh with at most so many is tiny
constexpr std::size_t kMaxTinyPlaced = 4'000'000;  // triangles of all copies of tiny meshes
constexpr float kEqualScales = 1e-4f;              // relative tolerance of squared scales
constexpr std::size_t kMaxVertices = std::numeric_limits<std::uint32_t>::max();

void drop_singular_instances(Scene& scene) {
  const std::size_t dropped = std::erase_if(
      scene.instances, [](const Instance& instance) { return !is_invertible(instance.to_world); });
  if (dropped > 0) {
    scene.warnings.push_back(fmt::format("dropped {} instance{} whose matrix cannot be inverted",
                                         dropped, dropped == 1 ? "" : "s"));
  }
}

// The factor by which the matrix scales lengths, or 0 when the factor depends on the direction.
float uniform_scale(const M44f& matrix) {
  const V3f rows[3] = {{matrix[0][0], matrix[0][1], matrix[0][2]},
                       {matrix[1][0], matrix[1][1], matrix[1][2]},
                       {matrix[2][0], matrix[2][1], matrix[2][2]}};
  const float square = rows[0].length2();
  for (int i = 0; i < 3; ++i) {
    const bool as_long = std::fabs(rows[i].length2() - square) <= kEqualScales * square;
    if (!as_long || std::fabs(rows[i].dot(rows[(i + 1) % 3])) > kEqualScales * square) return 0;
  }
  return std::sqrt(square);
}

struct Uses {
  std::size_t as_geometry = 0;
  std::size_t as_light = 0;
  bool fixed = false;  // must not be merged: an instance may scale its strands non-uniformly
};

// Strands of scenes that move are not merged either: their scale may be uniform in some frames
// only.
std::vector<Uses> count_uses(const Scene& scene) {
  const bool moves = !scene.animations.empty();
  std::vector<Uses> uses(scene.meshes.size());
  for (const Instance& instance : scene.instances) {
    Uses& of_mesh = uses[instance.mesh];
    ++(instance.light < 0 ? of_mesh.as_geometry : of_mesh.as_light);
    of_mesh.fixed |=
        scene.meshes[instance.mesh].has_strands() &&
        (moves || (is_invertible(instance.to_world) && uniform_scale(instance.to_world) == 0));
  }
  return uses;
}

// Chooses the meshes to merge; all instances of a chosen mesh that are not lights are merged.
std::vector<bool> choose_merged(const Scene& scene, const std::vector<Uses>& uses) {
  std::vector<bool> merged(scene.meshes.size(), false);
  std::size_t tiny_placed = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::size_t triangles = scene.meshes[m].primitive_count();
    const std::size_t placed = triangles * uses[m].as_geometry;
    if (uses[m].fixed) continue;
    merged[m] = uses[m].as_geometry == 1;
    if (merged[m] || triangles > kTinyTriangles || tiny_placed + placed > kMaxTinyPlaced) continue;
    merged[m] = uses[m].as_geometry > 1;
    tiny_placed += placed;
  }
  return merged;
}

std::vector<Instance> take_merged_instances(Scene& scene, const std::vector<bool>& merged) {
  const auto stays = [&](const Instance& instance) {
    return instance.light >= 0 || !merged[instance.mesh];
  };
  const auto first = std::stable_partition(scene.instances.begin(), scene.instances.end(), stays);
  std::vector<Instance> taken(first, scene.instances.end());
  scene.instances.erase(first, scene.instances.end());
  return taken;
}

struct Totals {
  std::size_t vertices = 0, triangles = 0;
  bool normals = false, uvs = false, vertex_alpha = false, colors = false, radii = false;
};

Totals measure(const Scene& scene, const std::vector<Instance>& instances) {
  Totals totals;
  for (const Instance& instance : instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    totals.vertices += mesh.positions.size();
    totals.triangles += mesh.primitive_count();
    totals.normals |= !mesh.normals.empty();
    totals.uvs |= !mesh.uvs.empty();
    totals.vertex_alpha |= !mesh.vertex_alpha.empty();
    totals.colors |= !mesh.colors.empty();
    totals.radii |= mesh.has_strands();
  }
  if (totals.vertices > kMaxVertices || totals.triangles > kMaxVertices / 3) {
    throw Error(ErrorKind::input,
                fmt::format("{}: {} vertices and {} triangles are more than one mesh can hold",
                            source_name(scene), totals.vertices, totals.triangles));
  }
  return totals;
}

// Transforms the vertices from `first` to the last one.
void transform_vertices(Mesh& mesh, std::size_t first, const M44f& to_world) {
  if (to_world == M44f{}) return;
  const float scale = mesh.has_strands() ? uniform_scale(to_world) : 1;
  const M44f of_normals = to_world.inverse().transposed();
  tbb::parallel_for(first, mesh.positions.size(), [&](std::size_t i) {
    mesh.positions[i] = mesh.positions[i] * to_world;
    if (i < mesh.normals.size()) {
      V3f normal;
      of_normals.multDirMatrix(mesh.normals[i], normal);
      mesh.normals[i] = normal.normalized();  // zero stays zero
    }
    if (mesh.has_strands()) mesh.radii[i] *= scale;
  });
}

// A mirroring matrix reverses the winding of triangles: two corners of each, from index `first` on,
// change places, so that the front stays the front.
void keep_fronts(Mesh& mesh, std::size_t first, const M44f& to_world) {
  if (mesh.has_strands() || Imath::M44d(to_world).determinant() >= 0) return;
  for (std::size_t i = first; i < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
}

void append_placed(Mesh& merged, const Mesh& mesh, const M44f& to_world, const Totals& totals) {
  const std::size_t first = merged.positions.size();
  merged.positions.insert(merged.positions.end(), mesh.positions.begin(), mesh.positions.end());
  if (totals.radii) {
    merged.radii.insert(merged.radii.end(), mesh.radii.begin(), mesh.radii.end());
  }
  if (totals.normals) {
    merged.normals.insert(merged.normals.end(), mesh.normals.begin(), mesh.normals.end());
    merged.normals.resize(merged.positions.size(), V3f(0, 0, 0));
  }
  transform_vertices(merged, first, to_world);
  const std::size_t first_index = merged.indices.size();
  const auto offset = static_cast<std::uint32_t>(first);
  for (const std::uint32_t index : mesh.indices) merged.indices.push_back(index + offset);
  keep_fronts(merged, first_index, to_world);
  merged.materials.insert(merged.materials.end(), mesh.materials.begin(), mesh.materials.end());
  if (totals.uvs) {
    merged.uvs.insert(merged.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    merged.uvs.resize(merged.positions.size(), V2f(0, 0));
  }
  if (totals.vertex_alpha) {
    merged.vertex_alpha.insert(merged.vertex_alpha.end(), mesh.vertex_alpha.begin(),
                               mesh.vertex_alpha.end());
    merged.vertex_alpha.resize(merged.positions.size(), 1.0f);
  }
  if (totals.colors) {
    merged.colors.insert(merged.colors.end(), mesh.colors.begin(), mesh.colors.end());
    merged.colors.resize(merged.positions.size(), V3f(1, 1, 1));
  }
}

// Gives the primitives that have no object yet that of their instance, if it has one.
void mark_object(Mesh& mesh, int object) {
  if (object >= 0) mesh.objects.resize(mesh.primitive_count(), static_cast<std::uint32_t>(object));
}

// Empties each mesh after its last use, so that large scenes are not in memory twice.
Mesh build_merged(Scene& scene, const std::vector<Instance>& instances,
                  const std::vector<Uses>& uses) {
  const Totals totals = measure(scene, instances);
  std::vector<std::size_t> left(uses.size());
  for (std::size_t m = 0; m < uses.size(); ++m) left[m] = uses[m].as_geometry + uses[m].as_light;
  Mesh merged;
  if (instances.size() > 1) {
    merged.positions.reserve(totals.vertices);
    merged.indices.reserve(3 * totals.triangles);
    merged.materials.reserve(totals.triangles);
  }
  for (const Instance& instance : instances) {
    Mesh& mesh = scene.meshes[instance.mesh];
    const bool last_use = --left[instance.mesh] == 0;
    if (last_use && instances.size() == 1) {
      merged = std::move(mesh);
      transform_vertices(merged, 0, instance.to_world);
      keep_fronts(merged, 0, instance.to_world);
      mark_object(merged, instance.object);
      return merged;
    }
    append_placed(merged, mesh, instance.to_world, totals);
    mark_object(merged, instance.object);
    if (last_use) mesh = Mesh{};
  }
  merged.name = totals.radii ? "merged strands" : "merged";
  return merged;
}

void merge_chosen(Scene& scene, const std::vector<bool>& merged) {
  const std::vector<Uses> uses = count_uses(scene);
  std::vector<Instance> taken = take_merged_instances(scene, merged);
  const auto strands = std::stable_partition(taken.begin(), taken.end(), [&](const Instance& i) {
    return !scene.meshes[i.mesh].has_strands();
  });
  for (const std::vector<Instance>& of_a_kind : {std::vector<Instance>(strands, taken.end()),
                                                 std::vector<Instance>(taken.begin(), strands)}) {
    if (of_a_kind.empty()) continue;
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(build_merged(scene, of_a_kind, uses));
    scene.instances.insert(scene.instances.begin(), instance);
  }
}

// Makes strands stop emitting. drop_unused() later drops their mesh lights.
void put_out_strands(Scene& scene) {
  std::size_t count = 0;
  for (Instance& instance : scene.instances) {
    if (instance.light < 0 || !scene.meshes[instance.mesh].has_strands()) continue;
    instance.light = -1;
    ++count;
  }
  if (count > 0) {
    scene.warnings.push_back(
        fmt::format("{} instance{} of strands should emit light, which only triangles do", count,
                    count == 1 ? "" : "s"));
  }
}

/// A frame in which everything is scaled to nothing is empty, and no error. A BVH needs a triangle:
/// this one is too small for a ray to hit.
void add_placeholder(Scene& scene) {
  constexpr float kSize = 1e-12f;
  Mesh triangle;
  triangle.name = "placeholder";
  triangle.positions = {V3f(0, 0, 0), V3f(kSize, 0, 0), V3f(0, kSize, 0)};
  triangle.indices = {0, 1, 2};
  triangle.materials = {0};
  if (scene.materials.empty()) scene.materials.emplace_back();
  Instance instance;
  instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(std::move(triangle));
  scene.instances.push_back(instance);
  scene.warnings.emplace_back("nothing is left in this frame");
}

/// Lists what was dropped, for the error that nothing is left.
std::string reasons(const Scene& scene) {
  std::string text;
  for (const std::string& warning : scene.warnings) {
    if (warning.starts_with("dropped")) text += (text.empty() ? " (" : "; ") + warning;
  }
  return text.empty() ? text : text + ")";
}

/// Leaves a scene without instances if nothing is left.
void merge(Scene& scene) {
  check_scene(scene);
  // Copies that are scaled to nothing for some frames count in all: a mesh that is merged in one
  // frame and not in the next would have no motion.
  const bool moves = !scene.animations.empty();
  if (!moves) drop_singular_instances(scene);
  put_out_strands(scene);
  const std::vector<bool> merged = choose_merged(scene, count_uses(scene));
  if (moves) drop_singular_instances(scene);
  merge_chosen(scene, merged);
  drop_unhittable_triangles(scene);
  drop_unused(scene);
}

}  // namespace

void merge_single_instances(Scene& scene) {
  merge(scene);
  if (scene.instances.empty()) {
    throw Error(ErrorKind::input,
                fmt::format("{}: there is nothing to render: no triangle or strand is left{}",
                            source_name(scene), reasons(scene)));
  }
  check_numeric_range(scene);
}

void merge_frame(Scene& scene) {
  if (scene.animations.empty()) return merge_single_instances(scene);
  merge(scene);
  if (scene.instances.empty()) add_placeholder(scene);
  check_numeric_range(scene);
}

}  // namespace dapple
