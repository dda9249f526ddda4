#include "bake/inside/closed_geometry.hpp"

#include <Imath/ImathBoxAlgo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "bake/inside/closed_parts.hpp"
#include "scene/invertible.hpp"

namespace dapple {
namespace {

/// Rays from a point that lies inside; the first few decide for most others.
constexpr int kRays = 16;

/// Boxes are larger by so many of their coordinates, for those of triangles in a plane.
constexpr float kMargin = 1e-6f;

/// A ray from a point, in object space.
struct RayFrom {
  V3d origin, direction;
};

/// Direction `index` of kRays, on the side of `normal`: a Kronecker sequence on the sphere.
V3f direction_towards(const V3f& normal, int index) {
  constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;  // as in texture_bake.cpp
  const auto fraction = [](double x) { return x - std::floor(x); };
  const double z = 2 * fraction(0.3 + index * kA) - 1;
  const double angle = 2 * std::numbers::pi * fraction(0.7 + index * kB);
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  const V3f direction(static_cast<float>(r * std::cos(angle)),
                      static_cast<float>(r * std::sin(angle)), static_cast<float>(z));
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

/// Whether the ray overlaps the box, by slabs.
bool overlaps(const RayFrom& ray, const Box3f& box) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    const double a = (double{box.min[axis]} - ray.origin[axis]) / d;
    const double b = (double{box.max[axis]} - ray.origin[axis]) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
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

/// How often a ray leaves parts, less how often it enters them.
using Windings = std::vector<std::pair<std::uint32_t, int>>;

void add(Windings& windings, std::uint32_t part, int crossing) {
  const auto found = std::find_if(windings.begin(), windings.end(),
                                  [part](const auto& entry) { return entry.first == part; });
  if (found == windings.end())
    windings.emplace_back(part, crossing);
  else
    found->second += crossing;
}

}  // namespace

ClosedGeometry::ClosedGeometry(Scene scene) {
  scene_.materials = std::move(scene.materials);
  scene_.instances = std::move(scene.instances);
  for (Mesh& mesh : scene.meshes) {
    Mesh& kept = scene_.meshes.emplace_back();
    if (mesh.has_strands()) continue;
    kept.positions = std::move(mesh.positions);
    kept.indices = std::move(mesh.indices);
    kept.materials = std::move(mesh.materials);
    kept.vertex_alpha = std::move(mesh.vertex_alpha);
  }
}

ClosedGeometry::Solids ClosedGeometry::solids_of(const Scene& scene, const Mesh& mesh) {
  const ClosedParts parts = closed_parts(mesh, opaque_triangles(scene, mesh));
  Solids solids;
  solids.bounds.resize(parts.count);
  std::vector<Box3f> boxes;
  for (std::size_t t = 0; t < parts.of_triangle.size(); ++t) {
    if (parts.of_triangle[t] == ClosedParts::kOpen) continue;
    std::array<V3f, 3>& corners = solids.triangles.emplace_back();
    Box3f box;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.positions[mesh.indices[3 * t + k]];
      box.extendBy(corners[k]);
    }
    solids.parts.push_back(parts.of_triangle[t]);
    boxes.push_back(with_margin(box));
    solids.bounds[parts.of_triangle[t]].extendBy(boxes.back());
  }
  solids.tree = BoxTree(boxes);
  solids.tree_of_parts = BoxTree(solids.bounds);
  return solids;
}

void ClosedGeometry::prepare() {
  if (is_prepared_) return;
  is_prepared_ = true;
  std::vector<Box3f> bounds, boxes;
  for (Mesh& mesh : scene_.meshes) {
    of_mesh_.push_back(solids_of(scene_, mesh));
    mesh = {};
    Box3f& box = bounds.emplace_back();
    for (const std::array<V3f, 3>& corners : of_mesh_.back().triangles)
      for (const V3f& corner : corners) box.extendBy(corner);
  }
  for (const Instance& instance : scene_.instances) {
    if (bounds[instance.mesh].isEmpty() || !is_invertible(instance.to_world)) continue;
    placements_.push_back({instance.to_world.inverse(), instance.mesh});
    boxes.push_back(with_margin(Imath::transform(bounds[instance.mesh], instance.to_world)));
  }
  boxes_ = BoxTree(boxes);
  scene_ = {};
}

bool ClosedGeometry::surrounds(const Solids& solids, const M44f& to_object, const V3f& point,
                               const V3f& normal) {
  V3f origin;
  to_object.multVecMatrix(point, origin);
  // Only parts around the point matter, and only as far as they reach.
  std::vector<std::uint32_t> around;  // parts that wind around it on all rays so far
  Box3f reach;
  solids.tree_of_parts.visit([&](const Box3f& box) { return box.intersects(origin); },
                             [&](std::uint32_t part) {
                               around.push_back(part);
                               reach.extendBy(solids.bounds[part]);
                             });
  for (int r = 0; r < kRays && !around.empty(); ++r) {
    V3f direction;
    to_object.multDirMatrix(direction_towards(normal, r), direction);
    const RayFrom ray{V3d(origin), V3d(direction)};
    Windings windings;
    solids.tree.visit([&](const Box3f& box) { return reach.intersects(box) && overlaps(ray, box); },
                      [&](std::uint32_t triangle) {
                        const int side = crossing(ray, solids.triangles[triangle]);
                        if (side != 0) add(windings, solids.parts[triangle], side);
                      });
    std::vector<std::uint32_t> surrounding;
    for (const auto& [part, winding] : windings)
      if (winding > 0 && std::find(around.begin(), around.end(), part) != around.end())
        surrounding.push_back(part);
    around = std::move(surrounding);
  }
  return !around.empty();
}

bool ClosedGeometry::surrounds(const V3f& point, const V3f& normal) const {
  bool found = false;
  boxes_.visit([&](const Box3f& box) { return !found && box.intersects(point); },
               [&](std::uint32_t i) {
                 found = found || surrounds(of_mesh_[placements_[i].mesh], placements_[i].to_object,
                                            point, normal);
               });
  return found;
}

}  // namespace dapple
