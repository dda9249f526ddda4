#include "bvh/opacity/closed_surface.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/opacity/connected_vertices.hpp"

namespace dapple {
namespace {

/// Maximum length of the sum of a closed surface's area vectors, relative to its area.
constexpr double kOpenShare = 0.1;

}  // namespace

std::vector<bool> closed_triangles(const OpaqueTriangles& opaque) {
  ConnectedVertices components = connect_triangles(
      opaque.positions().size(), opaque.count(), [](std::size_t) { return true; },
      [&](std::size_t t, int k) { return opaque.vertex(t, k); });
  struct Sums {
    Imath::V3d vector{0, 0, 0};
    double area = 0;
  };
  std::vector<Sums> sums(opaque.positions().size());
  for (std::size_t t = 0; t < opaque.count(); ++t) {
    const Imath::V3d vector(opaque.area_vector(t));
    Sums& component = sums[components.root(opaque.vertex(t, 0))];
    component.vector += vector;
    component.area += vector.length();
  }
  std::vector<bool> closed(opaque.count());
  bool any = false;
  for (std::size_t t = 0; t < closed.size(); ++t) {
    const Sums& component = sums[components.root(opaque.vertex(t, 0))];
    closed[t] = component.vector.length() < kOpenShare * component.area;
    any |= closed[t];
  }
  return any ? opaque.in_mesh(std::move(closed)) : std::vector<bool>{};
}

void SurfaceAreas::add(const V3f& area, float opacity, bool closed) {
  for (int axis = 0; axis < 3; ++axis) {
    V3f& side = !closed ? other : area[axis] > 0.0f ? front : back;
    side[axis] += opacity * std::fabs(area[axis]);
  }
}

void SurfaceAreas::add(const SurfaceAreas& areas) {
  front += areas.front;
  back += areas.back;
  other += areas.other;
}

float enclosed_share(const SurfaceAreas& a, const SurfaceAreas& b, int axis) {
  // The area whose opposite side is not in the same node; fronts are positive, backs negative.
  const float single_a = a.front[axis] - a.back[axis], single_b = b.front[axis] - b.back[axis];
  if (single_a * single_b >= 0.0f) return 0.0f;
  const auto occluded = [&](const SurfaceAreas& node) {
    return std::max(node.front[axis], node.back[axis]) + node.other[axis];
  };
  const float paired = std::min(std::fabs(single_a), std::fabs(single_b));
  return std::min(1.0f, paired / std::min(occluded(a), occluded(b)));
}

}  // namespace dapple
