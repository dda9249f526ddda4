// Disjoint sets (union-find), for the connected surfaces and strands of a mesh. In: which vertices
// or triangles belong together. Out: a root for each set.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dapple {

/// The numbers below `count`; at first each is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  /// Returns the root of the set of `element` and halves the path to it (Tarjan and van Leeuwen,
  /// "Worst-case Analysis of Set Union Algorithms", 1984).
  std::uint32_t root(std::uint32_t element) {
    while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
    return element;
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
DisjointSets connect_triangles(std::size_t vertices, std::size_t triangles, const Counts& counts,
                               const Vertex& vertex) {
  DisjointSets components(vertices);
  for (std::size_t t = 0; t < triangles; ++t) {
    if (!counts(t)) continue;
    const std::uint32_t first = vertex(t, 0);
    components.join(first, vertex(t, 1));
    components.join(first, vertex(t, 2));
  }
  return components;
}

}  // namespace dapple
