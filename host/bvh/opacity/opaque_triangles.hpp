// The opaque triangles of a mesh alone. In: a mesh and opacities. Out: triangles and vertices,
// numbered anew. Of foliage most triangles are not opaque: whoever needs tables of the vertices of
// opaque surfaces would mostly store nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Triangles of opacity 1 and their vertices, both in the order of the mesh, which must outlive the
/// object.
class OpaqueTriangles {
 public:
  /// `opacities`: one a triangle of the mesh.
  OpaqueTriangles(const Mesh& mesh, std::span<const float> opacities);
  OpaqueTriangles(const OpaqueTriangles&) = delete;
  OpaqueTriangles& operator=(const OpaqueTriangles&) = delete;

  [[nodiscard]] std::size_t count() const { return indices_.size() / 3; }
  [[nodiscard]] std::span<const V3f> positions() const { return positions_; }
  /// Three vertices for each triangle.
  [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }
  /// The vertex of corner `k` of a triangle, below positions().size().
  [[nodiscard]] std::uint32_t vertex(std::size_t triangle, int k) const {
    return indices_[3 * triangle + static_cast<std::size_t>(k)];
  }
  /// Normal of a triangle, as long as its area in square metres.
  [[nodiscard]] V3f area_vector(std::size_t triangle) const;
  /// Returns values of these triangles as those of the mesh's triangles, where all others have 0.
  template <class Value>
  [[nodiscard]] std::vector<Value> in_mesh(std::vector<Value> values) const {
    if (triangles_.empty()) return values;
    std::vector<Value> all(mesh_triangles_);
    for (std::size_t t = 0; t < triangles_.size(); ++t) all[triangles_[t]] = values[t];
    return all;
  }

 private:
  std::size_t mesh_triangles_;
  std::vector<std::uint32_t> triangles_;  ///< numbers in the mesh; empty if all are opaque
  std::vector<V3f> some_positions_;       ///< not used if all are opaque
  std::vector<std::uint32_t> some_indices_;
  std::span<const V3f> positions_;
  std::span<const std::uint32_t> indices_;
};

}  // namespace dapple
