// A small image of transmittance a box, per axis: how the things inside clump, which
// multiplying mean opacities forgets. Maps are made from triangles, composited upwards.
#pragma once

#include <algorithm>
#include <array>

#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

inline constexpr int kMapSize = 16;
inline constexpr int kMapCells = kMapSize * kMapSize;

/// The two axes a map along `axis` spans: columns, then rows.
inline constexpr int column_axis(int axis) { return (axis + 1) % 3; }
inline constexpr int row_axis(int axis) { return (axis + 2) % 3; }

/// Area of the box seen along `axis`, square metres.
inline float face_area(const Box3f& box, int axis) {
  return (box.max[column_axis(axis)] - box.min[column_axis(axis)]) *
         (box.max[row_axis(axis)] - box.min[row_axis(axis)]);
}

/// transmittance[axis][row * kMapSize + column], in [0,1].
struct CoverageMap {
  alignas(64) std::array<std::array<float, kMapCells>, 3> transmittance;

  CoverageMap() {
    for (auto& map : transmittance) map.fill(1.0f);
  }
  /// Mean opacity of the box along `axis`, [0,1].
  [[nodiscard]] float mean_opacity(int axis) const;
};

/// A triangle to be drawn. `opacity_at(u, v, share)` is its mean opacity around the
/// barycentrics over `share` of its area; used only when `opacity` is negative.
struct CoveringTriangle {
  V3f vertex, edge1, edge2;
  float opacity;
};

/// Multiplies a triangle inside `box` into the map, keeping its projected area exactly.
template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const CoveringTriangle& triangle,
           const OpacityAt& opacity_at);

/// The map of a node while its children are put in, one after the other. Children whose
/// boxes lie side by side in a cell add up; only where boxes overlap do they multiply.
/// Taking both as independent would let a quarter of the light through every joint.
class NodeCoverage {
 public:
  explicit NodeCoverage(const Box3f& box) : box_(box) {
    for (auto& covered : covered_) covered.fill(0.0f);
  }

  /// Puts in a child with its map over `child_box`, which lies in the node's box.
  void add(const CoverageMap& child, const Box3f& child_box);

  [[nodiscard]] const CoverageMap& map() const { return map_; }

 private:
  Box3f box_;
  CoverageMap map_;
  std::array<std::array<float, kMapCells>, 3> covered_;  ///< share of each cell that boxes cover
  std::array<Box3f, DAPPLE_BVH_WIDTH> children_;
  int child_count_ = 0;
};

/// A map of one opacity an axis all over.
CoverageMap uniform_map(const V3f& opacity);

// Implementation of cover().

/// A projected triangle in units of map cells, and the cells it may touch.
struct CellTriangle {
  V2f a, edge1, edge2;               ///< edges as the triangle has them, either orientation
  float area;                        ///< in cells
  int column0, column1, row0, row1;  ///< inclusive
};

/// False when the box has no area along `axis` or the triangle none in it.
bool project(const CoveringTriangle& triangle, const Box3f& box, int axis, CellTriangle& out);

/// Cells of a map, row after row; only the rows a triangle touches are valid.
struct CellCoverage {
  alignas(64) std::array<float, kMapCells> share;
};

/// Fraction of each cell in the touched rows that is covered; the sum is the triangle's
/// area exactly, up to cells that would be more than full.
void rasterize(const CellTriangle& triangle, CellCoverage& coverage);

/// map *= 1 - opacity * coverage over the touched rows of one axis' map.
void multiply_uniform(std::array<float, kMapCells>& map, const CellTriangle& triangle,
                      const CellCoverage& coverage, float opacity);

template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const CoveringTriangle& triangle,
           const OpacityAt& opacity_at) {
  CellCoverage coverage;
  for (int axis = 0; axis < 3; ++axis) {
    CellTriangle cells;
    if (!project(triangle, box, axis, cells)) continue;
    rasterize(cells, coverage);
    auto& out = map.transmittance[axis];
    if (triangle.opacity >= 0.0f) {
      multiply_uniform(out, cells, coverage, triangle.opacity);
      continue;
    }
    const float share = cells.area > 1.0f ? 1.0f / cells.area : 1.0f;
    const float inverse = 1.0f / (cells.edge1.x * cells.edge2.y - cells.edge1.y * cells.edge2.x);
    for (int row = cells.row0; row <= cells.row1; ++row) {
      for (int column = cells.column0; column <= cells.column1; ++column) {
        const int cell = row * kMapSize + column;
        if (coverage.share[cell] <= 0.0f) continue;
        const V2f p =
            V2f(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f) - cells.a;
        const float u =
            std::clamp((p.x * cells.edge2.y - p.y * cells.edge2.x) * inverse, 0.0f, 1.0f);
        const float v =
            std::clamp((cells.edge1.x * p.y - cells.edge1.y * p.x) * inverse, 0.0f, 1.0f);
        const float excess = std::max(u + v, 1.0f);
        out[cell] *= 1.0f - opacity_at(u / excess, v / excess, share) * coverage.share[cell];
      }
    }
  }
}

}  // namespace dapple
