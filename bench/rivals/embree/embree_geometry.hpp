// A scene in Embree's form. In: a dapple scene. Out: for each mesh its opaque triangles or curves,
// which need no filter, and its translucent ones with their opacities; and all placements. Several
// EmbreeScenes share it.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "rivals/embree/opacity_table.hpp"

namespace dapple::bench {

/// Ids of the two geometries of a mesh in its RTCScene.
enum : unsigned { kOpaqueGeometry = 0, kTranslucentGeometry = 1 };

struct EmbreeMesh {
  std::vector<V3f> positions;  ///< object space, and one unused: Embree reads 16 bytes for each
  std::vector<unsigned> triangles[2];  ///< indices of the corners, three per triangle
  /// Strands have these instead: x, y, z and radius of each curve vertex, and the index of the
  /// first vertex of each segment.
  std::vector<float> curve_vertices;
  std::vector<unsigned> curves[2];
  OpacityTable opacity;  ///< of the translucent primitives

  [[nodiscard]] const V3f& corner(unsigned geometry, unsigned triangle, unsigned k) const {
    return positions[triangles[geometry][3 * std::size_t{triangle} + k]];
  }
  [[nodiscard]] bool has_strands() const { return !curve_vertices.empty(); }
  /// Position and radius at end 0 or 1 of a segment.
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
  std::size_t triangles = 0;  ///< number of distinct triangles and segments that can be hit
  std::size_t bytes = 0;      ///< of positions, indices and opacities

  /// Leaves out triangles of opacity 0. Keeps pointers to the scene's textures.
  explicit EmbreeGeometry(const Scene& scene);
};

}  // namespace dapple::bench
