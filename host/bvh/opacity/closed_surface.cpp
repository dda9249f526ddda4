#include "bvh/opacity/closed_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

struct SurfaceSum {
  Imath::V3d vector{0, 0, 0};  ///< of area vectors
  double area = 0;

  [[nodiscard]] bool is_closed() const {
    return area > 0 && vector.length() <= kMaxOpenArea * area;
  }
};

/// Of each connected surface, by its root.
std::vector<SurfaceSum> sums_of(const OpaqueTriangles& opaque, DisjointSets& surfaces) {
  std::vector<SurfaceSum> sums(opaque.positions().size());
  for (std::size_t t = 0; t < opaque.count(); ++t) {
    const Imath::V3d vector(opaque.area_vector(t));
    SurfaceSum& sum = sums[surfaces.root(opaque.vertex(t, 0))];
    sum.vector += vector;
    sum.area += vector.length();
  }
  return sums;
}

/// What has come with an edge, in an open-addressing hash table.
class EdgeTable {
 public:
  struct Entry {
    std::uint64_t edge = 0;    ///< 0: none
    std::uint32_t vertex = 0;  ///< the first
    std::uint32_t triangles = 0;
  };
  explicit EdgeTable(std::size_t edges) : entries_(std::bit_ceil(2 * edges + 1)) {}
  Entry& find(std::uint64_t edge) {
    std::size_t at = (edge * 0x9e3779b97f4a7c15u >> 20) & (entries_.size() - 1);
    while (entries_[at].edge != edge && entries_[at].edge != 0)
      at = (at + 1) & (entries_.size() - 1);
    entries_[at].edge = edge;
    return entries_[at];
  }

 private:
  std::vector<Entry> entries_;
};

/// An edge of a triangle: the welded vertices of its ends, the smaller one in the upper half, and
/// the vertex of one of them.
struct SeamEdge {
  std::uint64_t ends;
  std::uint32_t vertex;
};

/// Edges of open surfaces whose ends are both at positions of several vertices.
std::vector<SeamEdge> possible_seams(const OpaqueTriangles& opaque,
                                     std::span<const std::uint32_t> welded, DisjointSets& surfaces,
                                     const std::vector<SurfaceSum>& sums) {
  std::vector<bool> is_shared(welded.size());
  bool any = false;
  for (std::uint32_t v = 0; v < welded.size(); ++v) {
    if (welded[v] == v) continue;
    is_shared[v] = is_shared[welded[v]] = any = true;
  }
  std::vector<SeamEdge> edges;
  for (std::size_t t = 0; any && t < opaque.count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = opaque.vertex(t, k), w = opaque.vertex(t, (k + 1) % 3);
      if (!is_shared[v] || !is_shared[w] || welded[v] == welded[w]) continue;
      if (sums[surfaces.root(v)].is_closed()) break;
      const auto [low, high] = std::minmax(welded[v], welded[w]);
      edges.push_back({std::uint64_t{low} << 32 | high, v});
    }
  }
  return edges;
}

/// Joins open surfaces along edges that two triangles have, by the positions of their ends. Leaves
/// that touch at a point, or of which many share an edge, stay apart. False: none were joined.
bool join_at_seams(const OpaqueTriangles& opaque, std::span<const std::uint32_t> welded,
                   const std::vector<SurfaceSum>& sums, DisjointSets& surfaces) {
  const std::vector<SeamEdge> edges = possible_seams(opaque, welded, surfaces, sums);
  EdgeTable table(edges.size());
  for (const SeamEdge& edge : edges) {
    EdgeTable::Entry& entry = table.find(edge.ends);
    if (entry.triangles++ == 0) entry.vertex = edge.vertex;
  }
  for (const SeamEdge& edge : edges) {
    const EdgeTable::Entry& entry = table.find(edge.ends);
    if (entry.triangles == 2) surfaces.join(edge.vertex, entry.vertex);
  }
  return !edges.empty();
}

}  // namespace

std::vector<bool> closed_triangles(const OpaqueTriangles& opaque,
                                   std::span<const std::uint32_t> welded) {
  DisjointSets surfaces = connect_triangles(
      opaque.positions().size(), opaque.count(), [](std::size_t) { return true; },
      [&](std::size_t t, int k) { return opaque.vertex(t, k); });
  std::vector<SurfaceSum> sums = sums_of(opaque, surfaces);
  if (join_at_seams(opaque, welded, sums, surfaces)) sums = sums_of(opaque, surfaces);
  std::vector<bool> closed(opaque.count());
  bool any = false;
  for (std::size_t t = 0; t < closed.size(); ++t) {
    closed[t] = sums[surfaces.root(opaque.vertex(t, 0))].is_closed();
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
