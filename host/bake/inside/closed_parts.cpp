#include "bake/inside/closed_parts.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <span>

#include "bake/samples/surface_samples.hpp"
#include "bake/vertex_groups.hpp"
#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/triangle_opacity.hpp"
#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

/// Share of the edges of a closed part that may lack a neighbour: up to a tube of three sides.
constexpr double kOpenEdges = 1.0 / 3 + 1e-6;

/// An edge of a triangle, which is joined to others by the positions of its ends.
struct Edge {
  std::uint64_t ends;      ///< the smaller place first
  std::uint32_t triangle;  ///< that has it
  bool forward;            ///< from the smaller place to the larger one, counterclockwise
  auto operator<=>(const Edge&) const = default;
};

/// Measures of a part.
struct PartSums {
  std::size_t edges = 0, open = 0;
  V3d vector{0, 0, 0};
  double area = 0;
  [[nodiscard]] bool is_closed() const {
    return edges > 0 && static_cast<double>(open) <= kOpenEdges * static_cast<double>(edges) &&
           vector.length() <= kMaxOpenArea * area;
  }
};

std::vector<Edge> sorted_edges(const Mesh& mesh, const std::vector<bool>& used) {
  const std::vector<std::uint32_t> place = places_of_vertices(mesh);
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < used.size(); ++t) {
    for (std::size_t k = 0; k < 3 && used[t]; ++k) {
      const std::uint64_t a = place[mesh.indices[3 * t + k]];
      const std::uint64_t b = place[mesh.indices[3 * t + (k + 1) % 3]];
      edges.push_back({std::min(a, b) << 32 | std::max(a, b), t, a < b});
    }
  }
  tbb::parallel_sort(edges.begin(), edges.end());
  return edges;
}

/// Calls visit(edges) for each set of edges between the same places.
template <class Visit>
void for_each_edge(std::span<const Edge> edges, Visit visit) {
  while (!edges.empty()) {
    std::size_t count = 1;
    while (count < edges.size() && edges[count].ends == edges[0].ends) ++count;
    visit(edges.first(count));
    edges = edges.subspan(count);
  }
}

/// For each triangle the first one of its part.
std::vector<std::uint32_t> joined_triangles(const std::vector<Edge>& edges, std::size_t triangles) {
  DisjointSets joined(triangles);
  for_each_edge(edges, [&](std::span<const Edge> same) {
    for (const Edge& edge : same) joined.join(same.front().triangle, edge.triangle);
  });
  std::vector<std::uint32_t> first(triangles);
  for (std::uint32_t t = 0; t < triangles; ++t) first[t] = joined.root(t);
  return first;
}

}  // namespace

std::vector<bool> opaque_triangles(const Scene& scene, const OpaqueTexels& texels,
                                   const Mesh& mesh) {
  std::vector<bool> opaque(mesh.primitive_count());
  for (std::uint32_t t = 0; t < opaque.size(); ++t)
    opaque[t] = uniform_opacity(scene, texels, mesh, t) == 1.0f;
  return opaque;
}

ClosedParts closed_parts(const Mesh& mesh, const std::vector<bool>& opaque) {
  std::vector<bool> used(opaque);
  for (std::size_t t = 0; t < used.size(); ++t) used[t] = used[t] && has_area(mesh, t);
  const std::vector<Edge> edges = sorted_edges(mesh, used);
  ClosedParts parts{joined_triangles(edges, used.size()), 0};
  std::vector<PartSums> sums(used.size());  // by first triangle
  for_each_edge(edges, [&](std::span<const Edge> same) {
    long balance = 0;
    for (const Edge& edge : same) balance += edge.forward ? 1 : -1;
    PartSums& sum = sums[parts.of_triangle[same.front().triangle]];
    sum.edges += same.size();
    sum.open += static_cast<std::size_t>(std::labs(balance));
  });
  for (std::size_t t = 0; t < used.size(); ++t) {
    if (!used[t]) continue;
    const V3d area(area_vector(mesh, t));
    sums[parts.of_triangle[t]].vector += area;
    sums[parts.of_triangle[t]].area += area.length();
  }
  std::vector<std::uint32_t> number(used.size(), ClosedParts::kOpen);
  for (std::size_t t = 0; t < used.size(); ++t) {
    const std::uint32_t first = parts.of_triangle[t];
    if (first == t && sums[t].is_closed()) number[t] = static_cast<std::uint32_t>(parts.count++);
    parts.of_triangle[t] = used[t] ? number[first] : ClosedParts::kOpen;
  }
  return parts;
}

}  // namespace dapple
