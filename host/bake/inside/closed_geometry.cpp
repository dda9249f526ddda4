#include "bake/inside/closed_geometry.hpp"

#include <Imath/ImathBoxAlgo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "bake/inside/closed_parts.hpp"
#include "sampling/random_choice.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

/// Rays from a point that lies inside; the first few decide for most others.
constexpr std::size_t kRays = 16;

/// Boxes are larger by so many of their coordinates, for those of triangles in a plane.
constexpr float kMargin = 1e-6f;

/// A ray from a point, in object space.
struct RayFrom {
  RayFrom() = default;
  RayFrom(const V3d& o, const V3d& d)
      : origin(o), direction(d), inverse(1 / d.x, 1 / d.y, 1 / d.z) {}
  V3d origin, direction, inverse;
};

/// The ray's parameters within a box; it misses the box if enter > leave.
struct Chord {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
};

/// By slabs.
inline Chord chord(const RayFrom& ray, const Box3f& box) {
  Chord chord;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (double{box.min[axis]} - ray.origin[axis]) * ray.inverse[axis];
    const double b = (double{box.max[axis]} - ray.origin[axis]) * ray.inverse[axis];
    chord.enter = std::max(chord.enter, std::min(a, b));
    chord.leave = std::min(chord.leave, std::max(a, b));
  }
  return chord;
}

bool overlaps(const RayFrom& ray, const Box3f& box) {
  const Chord inside = chord(ray, box);
  return inside.enter <= inside.leave;
}

/// Directions of rays, evenly spread over the sphere.
std::array<V3f, kRays> spread_directions() {
  std::array<V3f, kRays> directions;
  for (std::size_t r = 0; r < kRays; ++r) {
    const auto [u, v] = spread_pair(r, 0.3, 0.7);
    const double z = 2 * u - 1, angle = 2 * std::numbers::pi * v;
    const double radius = std::sqrt(std::max(0.0, 1 - z * z));
    directions[r] = V3f(static_cast<float>(radius * std::cos(angle)),
                        static_cast<float>(radius * std::sin(angle)), static_cast<float>(z));
  }
  return directions;
}

/// Direction `index` of kRays, on the side of `normal`.
V3f direction_towards(const V3f& normal, std::size_t index) {
  static const std::array<V3f, kRays> directions = spread_directions();
  const V3f& direction = directions[index];
  return direction.dot(normal) < 0 ? -direction : direction;
}

Box3f with_margin(Box3f box) {
  const auto grow = [](float value) { return std::fabs(value) * kMargin + 1e-30f; };
  for (int axis = 0; axis < 3; ++axis) {
    const float margin = std::max(grow(box.min[axis]), grow(box.max[axis]));
    box.min[axis] -= margin;
    box.max[axis] += margin;
  }
  return box;
}

using Rays = std::array<RayFrom, kRays>;

/// The rays from `origin`, in object space, on the side of `normal`.
Rays rays_from(const V3f& origin, const V3f& normal, const M44f& to_object) {
  Rays rays;
  for (std::size_t r = 0; r < kRays; ++r) {
    V3f direction;
    to_object.multDirMatrix(direction_towards(normal, r), direction);
    rays[r] = RayFrom(V3d(origin), V3d(direction));
  }
  return rays;
}

/// The ray that leaves the box first.
std::size_t shortest_in(const Rays& rays, const Box3f& box) {
  std::size_t shortest = 0;
  double length = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < kRays; ++r) {
    const double leave = chord(rays[r], box).leave;
    if (leave >= length) continue;
    length = leave;
    shortest = r;
  }
  return shortest;
}

/// 1: the ray leaves through the triangle, from its back to its front; -1: it enters; 0: it misses.
int crossing(const RayFrom& ray, const std::array<V3f, 3>& corners) {
  const V3d a = V3d(corners[0]) - ray.origin, b = V3d(corners[1]) - ray.origin;
  const V3d c = V3d(corners[2]) - ray.origin;
  // Edge functions: adjacent triangles have those of their common edge with opposite signs.
  const V3d ab = a.cross(b), bc = b.cross(c), ca = c.cross(a);
  const bool leaves = ab.dot(ray.direction) > 0;
  if ((bc.dot(ray.direction) > 0) != leaves || (ca.dot(ray.direction) > 0) != leaves) return 0;
  // Of the triangle's plane the distance along its normal has the sign of the ray's parameter.
  const double distance = a.dot(ab + bc + ca);
  if (leaves) return distance > 0 ? 1 : 0;
  return distance < 0 ? -1 : 0;
}

/// How often the ray leaves the part that has these triangles, less how often it enters it.
int winding(const BoxTree& tree, const std::array<V3f, 3>* triangles, const RayFrom& ray) {
  int winding = 0;
  tree.visit([&](const Box3f& box) { return overlaps(ray, box); },
             [&](std::uint32_t triangle) { winding += crossing(ray, triangles[triangle]); });
  return winding;
}

}  // namespace

ClosedGeometry::ClosedGeometry(Scene scene) {
  const OpaqueTexels texels(scene);
  for (Mesh& mesh : scene.meshes) {
    Surface& kept = surfaces_.emplace_back();
    if (mesh.has_strands()) continue;
    kept.opaque = opaque_triangles(scene, texels, mesh);
    kept.mesh.positions = std::move(mesh.positions);
    kept.mesh.indices = std::move(mesh.indices);
    kept.mesh.materials = std::move(mesh.materials);
  }
  instances_ = std::move(scene.instances);
}

ClosedGeometry::Solids ClosedGeometry::solids_of(const Surface& surface) {
  const Mesh& mesh = surface.mesh;
  const ClosedParts parts = closed_parts(mesh, surface.opaque);
  Solids solids;
  solids.parts.resize(parts.count);
  for (const std::uint32_t part : parts.of_triangle)
    if (part != ClosedParts::kOpen) ++solids.parts[part].end;
  std::uint32_t end = 0;
  for (Part& part : solids.parts) {
    part.begin = end;
    end += std::exchange(part.end, end);
  }
  solids.triangles.resize(end);
  std::vector<Box3f> boxes(end);
  for (std::size_t t = 0; t < parts.of_triangle.size(); ++t) {
    if (parts.of_triangle[t] == ClosedParts::kOpen) continue;
    Part& part = solids.parts[parts.of_triangle[t]];
    for (std::size_t k = 0; k < 3; ++k) {
      solids.triangles[part.end][k] = mesh.positions[mesh.indices[3 * t + k]];
      boxes[part.end].extendBy(solids.triangles[part.end][k]);
    }
    boxes[part.end] = with_margin(boxes[part.end]);
    part.bounds.extendBy(boxes[part.end++]);
  }
  std::vector<Box3f> bounds;
  for (Part& part : solids.parts) {
    bounds.push_back(part.bounds);
    part.tree = BoxTree(std::span(boxes).subspan(part.begin, part.end - part.begin));
  }
  solids.tree_of_parts = BoxTree(bounds);
  return solids;
}

void ClosedGeometry::prepare() {
  if (is_prepared_) return;
  is_prepared_ = true;
  std::vector<Box3f> bounds, boxes;
  for (Surface& surface : surfaces_) {
    of_mesh_.push_back(solids_of(surface));
    surface = {};
    Box3f& box = bounds.emplace_back();
    for (const std::array<V3f, 3>& corners : of_mesh_.back().triangles)
      for (const V3f& corner : corners) box.extendBy(corner);
  }
  for (const Instance& instance : instances_) {
    if (bounds[instance.mesh].isEmpty() || !is_invertible(instance.to_world)) continue;
    placements_.push_back({instance.to_world.inverse(), instance.mesh});
    boxes.push_back(with_margin(Imath::transform(bounds[instance.mesh], instance.to_world)));
  }
  boxes_ = BoxTree(boxes);
  surfaces_.clear();
  instances_.clear();
}

// Most points lie outside, and one ray tells. The shortest meets the fewest triangles.
bool ClosedGeometry::Solids::surrounds(const M44f& to_object, const V3f& point,
                                       const V3f& normal) const {
  V3f origin;
  to_object.multVecMatrix(point, origin);
  std::optional<Rays> rays;
  bool found = false;
  tree_of_parts.visit([&](const Box3f& box) { return !found && box.intersects(origin); },
                      [&](std::uint32_t i) {
                        if (!rays) rays = rays_from(origin, normal, to_object);
                        const Part& part = parts[i];
                        const auto winds = [&](const RayFrom& ray) {
                          return winding(part.tree, &triangles[part.begin], ray) > 0;
                        };
                        found = winds((*rays)[shortest_in(*rays, part.bounds)]) &&
                                std::all_of(rays->begin(), rays->end(), winds);
                      });
  return found;
}

bool ClosedGeometry::surrounds(const V3f& point, const V3f& normal) const {
  bool found = false;
  boxes_.visit([&](const Box3f& box) { return !found && box.intersects(point); },
               [&](std::uint32_t i) {
                 found = of_mesh_[placements_[i].mesh].surrounds(placements_[i].to_object, point,
                                                                 normal);
               });
  return found;
}

}  // namespace dapple
