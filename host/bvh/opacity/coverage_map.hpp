// Small images of a box's transmittance along each axis. They keep how the content clumps, which
// products of mean opacities lose. In: triangles and strips, or the maps of children. Out: a map.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "bvh/opacity/closed_surface.hpp"
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

void fill_cells(std::array<float, kMapCells>& cells, float value);

/// transmittance[axis][row * kMapSize + column], in [0,1].
struct CoverageMap {
  alignas(64) std::array<std::array<float, kMapCells>, 3> transmittance;

  CoverageMap() {
    for (auto& map : transmittance) fill_cells(map, 1.0f);
  }
  /// Mean opacity of the box along `axis`, [0,1].
  [[nodiscard]] float mean_opacity(int axis) const;
  /// Mean over the cells of opacity times the squared distance from the middle in half sizes;
  /// 2/3 of the mean opacity where it lies evenly.
  [[nodiscard]] float opacity_off_centre(int axis) const;
  /// Relative variance of opacity over the box: variance of the cells over the greatest that their
  /// mean allows, all axes together. 0: all cells are alike; 1: each cell is clear or opaque.
  [[nodiscard]] float clumping() const;
};

/// A triangle to be drawn. `opacity_at(triangle, u, v, share)` is its mean opacity around the
/// barycentrics over `share` of its area; asked only when `opacity` is negative.
struct CoveringTriangle {
  V3f vertex, edge1, edge2;
  float opacity;
  bool closed = false;  ///< part of a closed surface, opaque: closed_triangles()
};

/// The triangles for each axis. Triangles are the same for all axes; strips face their axis.
using Covering = std::array<std::span<const CoveringTriangle>, 3>;

/// Multiplies triangles inside `box` into the map, keeping their projected areas. Those
/// that meet along an edge lie side by side and add up, and so does each side of closed
/// surfaces, one of which hides the other; others overlap as if independent.
template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const Covering& covering,
           const OpacityAt& opacity_at);

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

/// What a group of triangles side by side hides of each cell of one axis' map.
struct HiddenCells {
  std::array<float, kMapCells> hidden;
  int row0 = kMapSize, row1 = -1;  ///< rows touched, inclusive

  HiddenCells() { fill_cells(hidden, 0.0f); }
  void add_uniform(const CellTriangle& triangle, const CellCoverage& coverage, float opacity);
  /// Hides what either hides: the two sides of closed surfaces. Empties the other.
  void enclose(HiddenCells& back);
  void clear();
  /// Multiplies what is left into `map` and empties this.
  void flush(std::array<float, kMapCells>& map);
};

/// Where a box lies in its node's along each axis, in map cells: 0 to kMapSize. Of use only
/// along axes in which the node has size.
struct CellRange {
  float from, to;
};
using CellRanges = std::array<CellRange, 3>;

/// The map of a node while its children are put in, one after the other. Children whose
/// boxes lie side by side in a cell add up; only where boxes overlap do they multiply.
/// Taking both as independent would let a quarter of the light through every joint. Fronts
/// of closed surfaces hide their backs.
class NodeCoverage {
 public:
  explicit NodeCoverage(const Box3f& box) : box_(box) {
    for (auto& covered : covered_) fill_cells(covered, 0.0f);
  }

  /// Puts in a child with its map over `child_box`, which lies in the node's box.
  void add(const CoverageMap& child, const Box3f& child_box, const SurfaceAreas& areas = {});

  /// Puts in a leaf's triangles, a single layer as is_single_layer() says, of uniform opacities.
  void add_layer(const Covering& covering, const Box3f& child_box, const SurfaceAreas& areas);

  [[nodiscard]] const CoverageMap& map() const { return map_; }
  [[nodiscard]] const SurfaceAreas& areas() const { return areas_; }

 private:
  [[nodiscard]] CellRanges cell_ranges(const Box3f& child) const;
  /// Puts one axis' `opacity` of the next child into the map, in these rows, inclusive.
  void merge(const CellRanges& child, int axis, int first_row, int last_row,
             const std::array<float, kMapCells>& opacity, const SurfaceAreas& areas);

  Box3f box_;
  CoverageMap map_;
  std::array<std::array<float, kMapCells>, 3> covered_;  ///< share of each cell that boxes cover
  SurfaceAreas areas_;
  HiddenCells layer_;  ///< of the leaf being put in; empty between them
  std::array<CellRanges, DAPPLE_BVH_WIDTH> children_;
  int child_count_ = 0;
};

/// Whether triangles of a leaf hide nothing of each other seen along any axis: they lie side by
/// side, edge to edge.
bool is_single_layer(std::span<const CoveringTriangle> triangles);

/// A map of one opacity an axis all over.
CoverageMap uniform_map(const V3f& opacity);

// Implementation of cover().

/// Bit k is set where two triangles share an edge and lie on either side of it, seen along axis k.
unsigned side_by_side(const CoveringTriangle& a, const CoveringTriangle& b);

template <class OpacityAt>
void add_varying(HiddenCells& cells, const CellTriangle& t, const CellCoverage& coverage,
                 const OpacityAt& opacity_at) {
  cells.row0 = std::min(cells.row0, t.row0);
  cells.row1 = std::max(cells.row1, t.row1);
  const float share = t.area > 1.0f ? 1.0f / t.area : 1.0f;
  const float inverse = 1.0f / (t.edge1.x * t.edge2.y - t.edge1.y * t.edge2.x);
  for (int row = t.row0; row <= t.row1; ++row) {
    for (int column = t.column0; column <= t.column1; ++column) {
      const int cell = row * kMapSize + column;
      if (coverage.share[cell] <= 0.0f) continue;
      const V2f p = V2f(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f) - t.a;
      const float u = std::clamp((p.x * t.edge2.y - p.y * t.edge2.x) * inverse, 0.0f, 1.0f);
      const float v = std::clamp((t.edge1.x * p.y - t.edge1.y * p.x) * inverse, 0.0f, 1.0f);
      const float excess = std::max(u + v, 1.0f);
      cells.hidden[cell] += opacity_at(u / excess, v / excess, share) * coverage.share[cell];
    }
  }
}

/// Draws the closed surfaces into `cells`, with `back` as scratch. Returns a bit for each
/// triangle done; leaves hold at most 8.
std::uint64_t draw_closed(const Box3f& box, std::span<const CoveringTriangle> triangles, int axis,
                          CellCoverage& coverage, HiddenCells& cells, HiddenCells& back);

template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const Covering& covering,
           const OpacityAt& opacity_at) {
  CellCoverage coverage;
  HiddenCells cells, back;
  for (int axis = 0; axis < 3; ++axis) {
    const std::span<const CoveringTriangle> triangles = covering[axis];
    std::uint64_t done = draw_closed(box, triangles, axis, coverage, cells, back);
    cells.flush(map.transmittance[axis]);
    for (std::size_t first = 0; first < triangles.size(); ++first) {
      // A group: this triangle and every later one beside a member of it.
      for (std::size_t t = first; t < triangles.size(); ++t) {
        const auto beside = [&](std::size_t other) {
          return (done >> other & 1u) &&
                 (side_by_side(triangles[other], triangles[t]) >> axis & 1u);
        };
        bool joins = t == first;
        for (std::size_t other = first; other < t && !joins; ++other) joins = beside(other);
        if (!joins || (done >> t & 1u)) continue;
        done |= std::uint64_t{1} << t;
        CellTriangle projected;
        if (!project(triangles[t], box, axis, projected)) continue;
        rasterize(projected, coverage);
        if (triangles[t].opacity >= 0.0f) {
          cells.add_uniform(projected, coverage, triangles[t].opacity);
        } else {
          add_varying(cells, projected, coverage, [&](float u, float v, float share) {
            return opacity_at(triangles[t], u, v, share);
          });
        }
      }
      cells.flush(map.transmittance[axis]);
    }
  }
}

template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, std::span<const CoveringTriangle> triangles,
           const OpacityAt& opacity_at) {
  cover(map, box, Covering{triangles, triangles, triangles}, opacity_at);
}

}  // namespace dapple
