// Small images of the transmittance of a box along each axis. They represent how the content clumps
// together; products of mean opacities do not. In: triangles and strips, or the maps of child
// nodes. Out: a map.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/covering_triangle.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

inline constexpr int kMapSize = 16;
inline constexpr int kMapCells = kMapSize * kMapSize;

/// Area of the box seen along `axis`, square metres.
inline float face_area(const Box3f& box, int axis) {
  return (box.max[column_axis(axis)] - box.min[column_axis(axis)]) *
         (box.max[row_axis(axis)] - box.min[row_axis(axis)]);
}

void fill_cells(std::array<float, kMapCells>& cells, float value);

/// Means over a view along an axis of opacity times x, times y, and times x^2 + y^2, where x and y
/// are the places along column_axis() and row_axis() from the middle, in half sizes of the box.
struct OpacityMoments {
  float column, row, square;
};

/// What the opacity of a node is computed from.
struct MapStatistics {
  V3f opacity;  ///< means of the views along the axes, [0,1]
  std::array<OpacityMoments, 3> moments;
  /// Relative variance of opacity over the box: the variance of the cells divided by the maximum
  /// that their mean permits, for all axes together. 0: all cells are alike; 1: each cell is either
  /// clear or opaque.
  float clumping;
};

/// transmittance[axis][row * kMapSize + column], in [0,1].
struct CoverageMap {
  alignas(64) std::array<std::array<float, kMapCells>, 3> transmittance;

  CoverageMap() {
    for (auto& map : transmittance) fill_cells(map, 1.0f);
  }
  /// Mean opacity of the box along `axis`, [0,1].
  [[nodiscard]] float mean_opacity(int axis) const;
  [[nodiscard]] MapStatistics statistics() const;
};

/// Multiplies the transmittances of triangles inside `box` into the map; their projected areas are
/// preserved. Opacities of triangles that share an edge and lie side by side add up. The opacities
/// of the fronts of closed surfaces add up, those of the backs too, and a cell takes the maximum of
/// both. All other triangles overlap as if independent.
template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const Covering& covering, const SharedEdges& edges,
           const OpacityAt& opacity_at);

/// A projected triangle or convex quad in units of map cells, and the cells it may touch.
struct CellPolygon {
  V2f a, edge1, edge2;  ///< in the order of the triangle, either orientation
  V2f fourth;           ///< of a quad: the corner across from `a`, from there
  bool is_quad;
  float area;                        ///< in cells
  int column0, column1, row0, row1;  ///< inclusive
};

/// Projects the triangle along `axis`. Returns false if the box or the triangle has no area along
/// `axis`.
bool project(const CoveringTriangle& triangle, const Box3f& box, int axis, CellPolygon& out);

/// Projects the quad of the triangle and `fourth`, which lies beyond its edge from corner 1 to
/// corner 2. Returns false if it is not convex, too.
bool project_quad(const CoveringTriangle& triangle, const V3f& fourth, const Box3f& box, int axis,
                  CellPolygon& out);

/// Cells of a map, row after row; only the rows that the triangle touches are valid.
struct CellCoverage {
  alignas(64) std::array<float, kMapCells> share;
};

/// Computes the covered fraction of each cell in the touched rows. The sum equals the polygon's
/// area, unless cells would be more than full.
void rasterize(const CellPolygon& polygon, CellCoverage& coverage);

/// The triangles of a leaf that are seen along an axis, and the box over which the map extends.
struct LeafView {
  std::span<const CoveringTriangle> triangles;
  const SharedEdges& edges;
  const Box3f& box;
  int axis;
};

/// The share of each cell that a group of triangles occludes, in the map of one axis. The triangles
/// lie side by side.
struct OccludedCells {
  std::array<float, kMapCells> occluded;
  int row0 = kMapSize, row1 = -1;  ///< rows touched, inclusive

  OccludedCells() { fill_cells(occluded, 0.0f); }
  /// Adds the cells that rasterize() gives, times `opacity`.
  void draw(const CellPolygon& polygon, float opacity);
  /// Draws triangle `t`, whose opacity is constant, as one quad with the next triangle that permits
  /// it. `done`: a mask with a bit for each triangle drawn before. Returns it with the new ones.
  std::uint32_t draw(const LeafView& leaf, std::size_t t, std::uint32_t done);
  /// Sets each cell to the maximum of this and `back`: fronts and backs of closed surfaces. Clears
  /// `back`.
  void enclose(OccludedCells& back);
  void clear();
  /// Multiplies the remaining transmittance into `map`, then clears this.
  void flush(std::array<float, kMapCells>& map);
};

/// The extent of a box inside the box of its node along an axis, in map cells: 0 to kMapSize. Valid
/// only for axes along which the node's box has size.
struct CellRange {
  float from, to;
};
using CellRanges = std::array<CellRange, 3>;

/// Builds the map of a node from its children, which are added one after the other. Where the
/// children's boxes lie side by side in a cell, opacities add up; only where boxes overlap do
/// transmittances multiply. If side by side counted as independent too, every joint would transmit
/// a quarter of the light. Fronts of closed surfaces occlude their backs.
class NodeCoverage {
 public:
  explicit NodeCoverage(const Box3f& box) : box_(box) {
    for (auto& covered : covered_) fill_cells(covered, 0.0f);
  }

  /// Adds a child by its map over `child_box`, which lies in the node's box.
  void add(const CoverageMap& child, const Box3f& child_box, const SurfaceAreas& areas = {});

  /// Adds a child that is filled uniformly: one `opacity` over its box for each axis.
  void add_uniform(const V3f& opacity, const Box3f& child_box);

  /// Adds the triangles of a leaf: a single layer, with constant opacities.
  void add_layer(const Covering& covering, const SharedEdges& edges, const Box3f& child_box,
                 const SurfaceAreas& areas);

  [[nodiscard]] const CoverageMap& map() const { return map_; }
  [[nodiscard]] const SurfaceAreas& areas() const { return areas_; }

 private:
  [[nodiscard]] CellRanges cell_ranges(const Box3f& child) const;
  /// Merges the `opacity` of the next child along one axis into the map, for these rows, inclusive.
  void merge(const CellRanges& child, int axis, int first_row, int last_row,
             const std::array<float, kMapCells>& opacity, const SurfaceAreas& areas);

  Box3f box_;
  CoverageMap map_;
  std::array<std::array<float, kMapCells>, 3> covered_;  ///< share of each cell that boxes cover
  SurfaceAreas areas_;
  OccludedCells layer_;  ///< scratch of add_layer(); empty between calls
  std::array<CellRanges, DAPPLE_BVH_WIDTH> children_;
  int child_count_ = 0;
};

// Implementation of cover().

template <class OpacityAt>
void add_varying(OccludedCells& cells, const CellPolygon& t, const CellCoverage& coverage,
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
      cells.occluded[cell] += opacity_at(u / excess, v / excess, share) * coverage.share[cell];
    }
  }
}

/// Rasterizes the triangles of closed surfaces into `cells`, with `back` as scratch. Returns a mask
/// with a bit for each triangle done.
std::uint32_t draw_closed(const Box3f& box, std::span<const CoveringTriangle> triangles, int axis,
                          OccludedCells& cells, OccludedCells& back);

template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, const Covering& covering, const SharedEdges& edges,
           const OpacityAt& opacity_at) {
  CellCoverage coverage;
  OccludedCells cells, back;
  for (int axis = 0; axis < 3; ++axis) {
    const std::span<const CoveringTriangle> triangles = covering[axis];
    std::uint32_t done = draw_closed(box, triangles, axis, cells, back);
    cells.flush(map.transmittance[axis]);
    for (std::size_t first = 0; first < triangles.size(); ++first) {
      // A group: this triangle and every later one that lies side by side with a member.
      // A triangle that was drawn in a group has drawn its neighbours there, too. Only those of
      // draw_closed() have not: the first pass finds them.
      if (first > 0 && (done >> first & 1u)) continue;
      for (std::size_t t = first; t < triangles.size(); ++t) {
        if (done >> t & 1u) continue;
        if (t != first && (edges.neighbours(axis, t) & done) >> first == 0) continue;
        if (triangles[t].opacity >= 0.0f) {
          done = cells.draw({triangles, edges, box, axis}, t, done);
          continue;
        }
        done |= 1u << t;
        CellPolygon projected;
        if (!project(triangles[t], box, axis, projected)) continue;
        rasterize(projected, coverage);
        add_varying(cells, projected, coverage, [&](float u, float v, float share) {
          return opacity_at(triangles[t], u, v, share);
        });
      }
      cells.flush(map.transmittance[axis]);
    }
  }
}

template <class OpacityAt>
void cover(CoverageMap& map, const Box3f& box, std::span<const CoveringTriangle> triangles,
           const OpacityAt& opacity_at) {
  const Covering covering{triangles, triangles, triangles};
  cover(map, box, covering, SharedEdges(covering), opacity_at);
}

}  // namespace dapple
