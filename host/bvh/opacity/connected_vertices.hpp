// Connected surfaces of a mesh: which vertices triangles join. In: a mesh. Out: a root for each
// connected component.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dapple {

/// A union-find forest of vertices that triangles connect, with one root for each component.
class ConnectedVertices {
 public:
  explicit ConnectedVertices(std::size_t vertices) : parent_(vertices) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  /// Returns the root of `vertex` and halves the path to it (Tarjan and van Leeuwen, "Worst-case
  /// Analysis of Set Union Algorithms", 1984).
  std::uint32_t root(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Joins the corners of each triangle t for which `counts(t)`: vertex(t, 0) to vertex(t, 2), which
/// are below `vertices`.
template <class Counts, class Vertex>
ConnectedVertices connect_triangles(std::size_t vertices, std::size_t triangles,
                                    const Counts& counts, const Vertex& vertex) {
  ConnectedVertices components(vertices);
  for (std::size_t t = 0; t < triangles; ++t) {
    if (!counts(t)) continue;
    const std::uint32_t first = vertex(t, 0);
    components.join(first, vertex(t, 1));
    components.join(first, vertex(t, 2));
  }
  return components;
}

}  // namespace dapple
