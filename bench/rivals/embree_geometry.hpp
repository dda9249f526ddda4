// A scene as Embree takes it: of every mesh its opaque triangles or curves, which need no filter,
// and its translucent ones, with their opacities; and where each mesh is placed. Shared by the
// scenes built from it.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "rivals/opacity_table.hpp"

namespace dapple::bench {

/// Numbers of a mesh's two geometries in its RTCScene.
enum : unsigned { kOpaqueGeometry = 0, kTranslucentGeometry = 1 };

struct EmbreeMesh {
  std::vector<V3f> positions;          ///< object space, one more than used: Embree reads 16 bytes
  std::vector<unsigned> triangles[2];  ///< indices of the corners, three a triangle
  /// Of strands, in place of both: x, y, z, radius of each vertex of a curve in turn, and the first
  /// vertex of each segment.
  std::vector<float> curve_vertices;
  std::vector<unsigned> curves[2];
  OpacityTable opacity;  ///< of the translucent ones

  [[nodiscard]] const V3f& corner(unsigned geometry, unsigned triangle, unsigned k) const {
    return positions[triangles[geometry][3 * std::size_t{triangle} + k]];
  }
  [[nodiscard]] bool has_strands() const { return !curve_vertices.empty(); }
  /// An end, 0 or 1, of a segment: place and radius.
  [[nodiscard]] const float* curve_end(unsigned geometry, unsigned segment, unsigned end) const {
    return &curve_vertices[4 * std::size_t{curves[geometry][segment] + end}];
  }
};

struct EmbreePlacement {
  std::uint32_t mesh = 0;
  M44f to_world;       ///< Imath's convention: p_world = p_object * to_world
  M44f normal_matrix;  ///< inverse transpose of its upper 3x3
};

struct EmbreeGeometry {
  std::vector<EmbreeMesh> meshes;
  std::vector<EmbreePlacement> placements;
  bool flat = false;  ///< the only mesh is placed once, in world space: no instance is needed
  std::size_t triangles = 0;  ///< and segments, distinct, that can be hit
  std::size_t bytes = 0;      ///< of positions, indices and opacities

  /// Invisible triangles (opacity 0) are left out. Keeps pointers to the scene's textures.
  explicit EmbreeGeometry(const Scene& scene);
};

}  // namespace dapple::bench
