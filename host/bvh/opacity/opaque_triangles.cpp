#include "bvh/opacity/opaque_triangles.hpp"

#include <algorithm>
#include <bit>

namespace dapple {
namespace {

/// A set of vertices, numbered in order. Takes two bits for each vertex of the mesh.
class VertexSet {
 public:
  explicit VertexSet(std::size_t vertices) : words_(vertices / 32 + 1), before_(words_.size()) {}

  void add(std::uint32_t vertex) { words_[vertex / 32] |= 1u << vertex % 32; }
  /// To be called when all vertices are in the set; returns their number.
  std::size_t number() {
    std::uint32_t count = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = count;
      count += static_cast<std::uint32_t>(std::popcount(words_[w]));
    }
    return count;
  }
  [[nodiscard]] bool has(std::uint32_t vertex) const {
    return words_[vertex / 32] >> vertex % 32 & 1u;
  }
  [[nodiscard]] std::uint32_t number_of(std::uint32_t vertex) const {
    const std::uint32_t lower = words_[vertex / 32] & ((1u << vertex % 32) - 1);
    return before_[vertex / 32] + static_cast<std::uint32_t>(std::popcount(lower));
  }

 private:
  std::vector<std::uint32_t> words_, before_;
};

}  // namespace

OpaqueTriangles::OpaqueTriangles(const Mesh& mesh, std::span<const float> opacities)
    : mesh_triangles_(opacities.size()) {
  const auto opaque = std::count(opacities.begin(), opacities.end(), 1.0f);
  if (opaque == 0) return;
  positions_ = mesh.positions;
  indices_ = mesh.indices;
  if (static_cast<std::size_t>(opaque) == mesh_triangles_) return;
  triangles_.reserve(static_cast<std::size_t>(opaque));
  VertexSet vertices(mesh.positions.size());
  for (std::uint32_t t = 0; t < mesh_triangles_; ++t) {
    if (opacities[t] != 1.0f) continue;
    triangles_.push_back(t);
    for (std::size_t k = 0; k < 3; ++k) vertices.add(mesh.indices[3 * std::size_t{t} + k]);
  }
  some_positions_.reserve(vertices.number());
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (vertices.has(v)) some_positions_.push_back(mesh.positions[v]);
  some_indices_.reserve(3 * triangles_.size());
  for (const std::uint32_t t : triangles_)
    for (std::size_t k = 0; k < 3; ++k)
      some_indices_.push_back(vertices.number_of(mesh.indices[3 * std::size_t{t} + k]));
  positions_ = some_positions_;
  indices_ = some_indices_;
}

V3f OpaqueTriangles::area_vector(std::size_t triangle) const {
  const V3f& a = positions_[vertex(triangle, 0)];
  return 0.5f * (positions_[vertex(triangle, 1)] - a).cross(positions_[vertex(triangle, 2)] - a);
}

}  // namespace dapple
