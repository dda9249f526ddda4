#include "bake/vertex_groups.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>

#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

/// Cosine of the angle up to which normals are similar: 45 degrees.
constexpr float kSimilar = 0.70710678f;

/// Groups at one position among which a vertex's is searched.
constexpr std::ptrdiff_t kMaxSearched = 64;

/// Sum of the area vectors of the triangles around each vertex.
std::vector<V3f> vertex_normals(const Mesh& mesh) {
  std::vector<V3f> normals(mesh.positions.size(), V3f(0, 0, 0));
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const V3f area = area_vector(mesh, t);
    for (std::size_t corner = 3 * t; corner < 3 * t + 3; ++corner)
      normals[mesh.indices[corner]] += area;
  }
  for (V3f& normal : normals) normal.normalize();
  return normals;
}

/// The vertices of which all triangles are two-sided.
std::vector<bool> two_sided_vertices(const Mesh& mesh, const std::vector<bool>& two_sided) {
  std::vector<bool> vertices(mesh.positions.size(), !two_sided.empty());
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    for (std::size_t corner = 3 * t; corner < 3 * t + 3 && !two_sided[t]; ++corner)
      vertices[mesh.indices[corner]] = false;
  return vertices;
}

/// A vertex and its position as bits, which compare fast.
struct PlacedVertex {
  std::array<std::uint32_t, 3> position;
  std::uint32_t vertex;
  auto operator<=>(const PlacedVertex&) const = default;
};

/// Orders positions by their bits, of which equal numbers have the same: -0 becomes 0. Equal ones
/// are in the order of vertices.
std::vector<PlacedVertex> order_by_position(const std::vector<V3f>& positions) {
  std::vector<PlacedVertex> order(positions.size());
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t i) {
    order[i] = {std::bit_cast<std::array<std::uint32_t, 3>>(std::array<float, 3>{
                    positions[i].x + 0.0f, positions[i].y + 0.0f, positions[i].z + 0.0f}),
                static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order.begin(), order.end());
  return order;
}

}  // namespace

V3f area_vector(const Mesh& mesh, std::size_t triangle) {
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  const V3f& a = mesh.positions[corner[0]];
  return (mesh.positions[corner[1]] - a).cross(mesh.positions[corner[2]] - a);
}

VertexGroups group_vertices(const Mesh& mesh, const std::vector<bool>& two_sided) {
  const std::vector<V3f> normals = vertex_normals(mesh);
  const std::vector<bool> has_sides = two_sided_vertices(mesh, two_sided);
  const std::vector<PlacedVertex> order = order_by_position(mesh.positions);
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> first(mesh.positions.size(), kNone);  // vertex that began the group
  const auto similar = [&](std::uint32_t a, std::uint32_t b) {
    const float cosine = normals[a].dot(normals[b]);
    return (has_sides[a] && has_sides[b] ? std::fabs(cosine) : cosine) >= kSimilar;
  };
  std::vector<std::uint32_t> firsts;  // few: the sides of an edge or corner
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && order[begin].position == order[end].position) ++end;
    if (end == begin + 1) {
      first[order[begin].vertex] = order[begin].vertex;
      continue;
    }
    firsts.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t vertex = order[i].vertex;
      // Only the last ones are searched, so that no file makes this quadratic.
      const auto begin_search = static_cast<std::ptrdiff_t>(firsts.size()) > kMaxSearched
                                    ? firsts.end() - kMaxSearched
                                    : firsts.begin();
      const auto found = std::find_if(begin_search, firsts.end(),
                                      [&](std::uint32_t f) { return similar(f, vertex); });
      first[vertex] = found == firsts.end() ? vertex : *found;
      if (first[vertex] == vertex) firsts.push_back(vertex);
    }
  }
  VertexGroups groups;
  groups.of_vertex.resize(first.size());
  groups.turned.resize(first.size());
  for (std::uint32_t vertex = 0; vertex < first.size(); ++vertex) {
    groups.of_vertex[vertex] = first[vertex] == vertex ? static_cast<std::uint32_t>(groups.count++)
                                                       : groups.of_vertex[first[vertex]];
    groups.turned[vertex] = normals[vertex].dot(normals[first[vertex]]) < 0;
  }
  return groups;
}

std::vector<std::uint32_t> places_of_vertices(const Mesh& mesh) {
  const std::vector<PlacedVertex> order = order_by_position(mesh.positions);
  std::vector<std::uint32_t> places(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_first = i == 0 || order[i].position != order[i - 1].position;
    places[order[i].vertex] = is_first ? order[i].vertex : places[order[i - 1].vertex];
  }
  return places;
}

VertexGroups one_group(std::size_t vertices) {
  return {std::vector<std::uint32_t>(vertices), std::vector<bool>(vertices), 1};
}

std::vector<std::uint32_t> connected_parts(const Mesh& mesh, const VertexGroups& groups) {
  DisjointSets joined = connect_triangles(
      groups.count, mesh.primitive_count(), [](std::size_t) { return true; },
      [&](std::size_t t, int k) {
        return groups.of_vertex[mesh.indices[3 * t + static_cast<std::size_t>(k)]];
      });
  std::vector<std::uint32_t> parts(groups.count);
  for (std::uint32_t group = 0; group < parts.size(); ++group) parts[group] = joined.root(group);
  return parts;
}

}  // namespace dapple
