// Filters triangles and segments of strands and renumbers the indices: see triangle_cleanup.hpp.
// A mesh without a fault keeps its numbers.
#include "scene/check/triangle_cleanup.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;
// Twice an area, in square metres. Below it the squared length of a normal underflows in float. A
// triangle with sides of one nanometre is larger.
constexpr double kMinDoubleArea = 1e-19;

// The minimum length of a segment, in metres.
constexpr double kMinLength = 1e-15;

enum class Fault : std::uint8_t { none, not_finite, no_area, no_length, no_radius };

Fault fault_of_segment(const Mesh& mesh, std::size_t segment) {
  const std::uint32_t begin = mesh.indices[2 * segment], end = mesh.indices[2 * segment + 1];
  const Imath::V3d a(mesh.positions[begin]), b(mesh.positions[end]), sum = a + b;
  const double radii = double{mesh.radii[begin]} + mesh.radii[end];
  if (!std::isfinite(sum.x + sum.y + sum.z + radii)) return Fault::not_finite;
  // One radius may be 0: strands may end in a point.
  if (mesh.radii[begin] < 0 || mesh.radii[end] < 0 || radii <= 0) return Fault::no_radius;
  return (b - a).length() > kMinLength ? Fault::none : Fault::no_length;
}

Fault fault_of(const Mesh& mesh, std::size_t triangle) {
  if (mesh.has_strands()) return fault_of_segment(mesh, triangle);
  Imath::V3d corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = Imath::V3d(mesh.positions[mesh.indices[3 * triangle + k]]);
  }
  // Double arithmetic: sums and products of floats cannot overflow in it.
  const Imath::V3d sum = corner[0] + corner[1] + corner[2];
  if (!std::isfinite(sum.x + sum.y + sum.z)) return Fault::not_finite;
  const Imath::V3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  return normal.length() > kMinDoubleArea ? Fault::none : Fault::no_area;
}

struct Faults {
  std::array<std::size_t, 5> count{};  // indexed by Fault

  [[nodiscard]] std::size_t of(Fault fault) const { return count[static_cast<std::size_t>(fault)]; }
  void add(Fault fault) { ++count[static_cast<std::size_t>(fault)]; }
  Faults& operator+=(const Faults& other) {
    for (std::size_t i = 0; i < count.size(); ++i) count[i] += other.count[i];
    return *this;
  }
  [[nodiscard]] bool any() const {
    return std::accumulate(count.begin() + 1, count.end(), std::size_t{0}) > 0;
  }
};

Faults count_faults(const Mesh& mesh) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, mesh.primitive_count(), 8192), Faults{},
      [&](const Range& range, Faults faults) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) {
          faults.add(fault_of(mesh, t));
        }
        return faults;
      },
      [](Faults a, const Faults& b) { return a += b; });
}

// Makes both ends of a segment without length one vertex, so that the strand has no gap there.
void join_ends(Mesh& mesh) {
  DisjointSets same(mesh.positions.size());
  for (std::size_t s = 0; s < mesh.primitive_count(); ++s)
    if (fault_of(mesh, s) == Fault::no_length)
      same.join(mesh.indices[2 * s], mesh.indices[2 * s + 1]);
  for (std::uint32_t& index : mesh.indices) index = same.root(index);
}

void keep_sound_primitives(Mesh& mesh) {
  if (mesh.has_strands()) join_ends(mesh);
  const std::size_t corners = mesh.has_strands() ? 2 : 3;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (fault_of(mesh, t) != Fault::none) continue;
    std::copy_n(&mesh.indices[corners * t], corners, &mesh.indices[corners * kept]);
    if (!mesh.objects.empty()) mesh.objects[kept] = mesh.objects[t];
    mesh.materials[kept++] = mesh.materials[t];
  }
  mesh.indices.resize(corners * kept);
  mesh.materials.resize(kept);
  if (!mesh.objects.empty()) mesh.objects.resize(kept);
}

template <typename Value>
void keep_at(std::vector<Value>& values, const std::vector<std::uint32_t>& new_numbers,
             std::size_t kept) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (new_numbers[i] != kUnused) values[new_numbers[i]] = values[i];
  }
  values.resize(kept);
}

// Vertices keep their order, so keep_at() moves values only towards the front, in place.
void keep_used_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> new_numbers(mesh.positions.size(), kUnused);
  for (const std::uint32_t index : mesh.indices) new_numbers[index] = 0;
  std::uint32_t kept = 0;
  for (std::uint32_t& number : new_numbers) {
    if (number != kUnused) number = kept++;
  }
  for (std::uint32_t& index : mesh.indices) index = new_numbers[index];
  keep_at(mesh.positions, new_numbers, kept);
  keep_at(mesh.radii, new_numbers, kept);
  keep_at(mesh.normals, new_numbers, kept);
  keep_at(mesh.uvs, new_numbers, kept);
  keep_at(mesh.vertex_alpha, new_numbers, kept);
  keep_at(mesh.colors, new_numbers, kept);
  mesh.sources.clear();
}

void warn_dropped(Scene& scene, std::size_t count, const char* primitive, const char* what) {
  if (count == 0) return;
  scene.warnings.push_back(
      fmt::format("dropped {} {}{} {}", count, primitive, count == 1 ? "" : "s", what));
}

std::vector<bool> find_placed(const Scene& scene) {
  std::vector<bool> placed(scene.meshes.size(), false);
  for (const Instance& instance : scene.instances) placed[instance.mesh] = true;
  return placed;
}

// Erases the items that are not wanted. Returns the new number of each old one, or kUnused.
template <typename Item>
std::vector<std::uint32_t> keep_wanted(std::vector<Item>& items, const std::vector<bool>& wanted) {
  std::vector<std::uint32_t> new_numbers(items.size(), kUnused);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!wanted[i]) continue;
    if (kept != i) items[kept] = std::move(items[i]);
    new_numbers[i] = kept++;
  }
  items.resize(kept);
  return new_numbers;
}

/// Those of scenes that move stay dark, so that all frames of a sequence have the same layers.
void drop_dark_mesh_lights(Scene& scene) {
  std::vector<bool> wanted(scene.lights.size(), false);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    wanted[i] = scene.lights[i].kind != LightKind::mesh;
  }
  for (const Instance& instance : scene.instances) {
    if (instance.light >= 0) wanted[static_cast<std::size_t>(instance.light)] = true;
  }
  const bool moves = !scene.animations.empty();
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (wanted[i]) continue;
    const std::string& name = scene.lights[i].name;
    scene.warnings.push_back(
        moves ? fmt::format("light \"{}\" is dark: it has no triangle", name)
              : fmt::format("dropped light \"{}\", which has no triangle", name));
  }
  if (moves) return;
  const std::vector<std::uint32_t> new_numbers = keep_wanted(scene.lights, wanted);
  for (Instance& instance : scene.instances) {
    if (instance.light < 0) continue;
    instance.light = static_cast<int>(new_numbers[static_cast<std::size_t>(instance.light)]);
  }
}

}  // namespace

void drop_unhittable_triangles(Scene& scene) {
  const std::vector<bool> placed = find_placed(scene);
  Faults triangles, segments;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (!placed[m]) continue;
    const Faults faults = count_faults(scene.meshes[m]);
    if (!faults.any()) continue;
    (scene.meshes[m].has_strands() ? segments : triangles) += faults;
    keep_sound_primitives(scene.meshes[m]);
    keep_used_vertices(scene.meshes[m]);
  }
  warn_dropped(scene, triangles.of(Fault::not_finite), "triangle", "with non-finite vertices");
  warn_dropped(scene, triangles.of(Fault::no_area), "triangle", "without an area");
  constexpr const char* kSegment = "segment";
  warn_dropped(scene, segments.of(Fault::not_finite), kSegment, "with non-finite ends or radii");
  warn_dropped(scene, segments.of(Fault::no_radius), kSegment, "without a radius");
  warn_dropped(scene, segments.of(Fault::no_length), kSegment, "without a length");
}

void drop_unused(Scene& scene) {
  std::erase_if(scene.instances, [&](const Instance& instance) {
    return scene.meshes[instance.mesh].primitive_count() == 0;
  });
  const std::vector<std::uint32_t> new_numbers = keep_wanted(scene.meshes, find_placed(scene));
  for (Instance& instance : scene.instances) instance.mesh = new_numbers[instance.mesh];
  drop_dark_mesh_lights(scene);
}

}  // namespace dapple
