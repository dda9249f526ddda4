// Compositing the children's coverage maps into their parent's.
#include <algorithm>
#include <cmath>

#include "bvh/coverage_map.hpp"
#include "bvh/map_row.hpp"
#include "bvh/multiversion.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;

/// Where each cell of a child's axis lands in its parent's: a first cell, and how much of
/// a parent cell's width goes to it and to the next.
struct AxisResampling {
  std::array<int, kMapSize> cell;
  std::array<float, kMapSize> here, next;
  int first, last;  ///< parent cells touched

  AxisResampling(const Box3f& parent, const Box3f& child, int axis) {
    const float to_cells = kSize / (parent.max[axis] - parent.min[axis]);
    const float start = std::clamp((child.min[axis] - parent.min[axis]) * to_cells, 0.0f, kSize);
    const float width =
        std::min((child.max[axis] - child.min[axis]) * to_cells, kSize - start) / kSize;
    for (int i = 0; i < kMapSize; ++i) {
      const float from = start + width * static_cast<float>(i);
      const float to = start + width * static_cast<float>(i + 1);
      cell[i] = std::min(static_cast<int>(from), kMapSize - 1);
      const float border = static_cast<float>(cell[i] + 1);
      here[i] = std::min(to, border) - from;
      next[i] = cell[i] + 1 < kMapSize ? std::max(0.0f, to - border) : 0.0f;
    }
    first = cell[0];
    last = std::min(cell[kMapSize - 1] + 1, kMapSize - 1);
  }
};

/// Share of each of the parent's cells, along one axis, that lies between two coordinates.
using AxisShare = std::array<float, kMapSize>;

AxisShare axis_share(const Box3f& parent, const Box3f& box, int axis) {
  const float to_cells = kSize / (parent.max[axis] - parent.min[axis]);
  const float from = (box.min[axis] - parent.min[axis]) * to_cells;
  const float to = (box.max[axis] - parent.min[axis]) * to_cells;
  AxisShare share;
  for (int i = 0; i < kMapSize; ++i) {
    const float cell = static_cast<float>(i);
    share[i] = std::max(0.0f, std::min(to, cell + 1.0f) - std::max(from, cell));
  }
  return share;
}

using Cells = std::array<float, kMapCells>;

/// Adds to `overlap` what two boxes share of each cell.
void add_overlap(const Box3f& parent, const Box3f& a, const Box3f& b, int axis, Cells& overlap) {
  const int u = column_axis(axis), v = row_axis(axis);
  const Box3f both(
      V3f(std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)),
      V3f(std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)));
  if (both.min[u] >= both.max[u] || both.min[v] >= both.max[v]) return;
  const AxisShare across = axis_share(parent, both, u), down = axis_share(parent, both, v);
  for (int row = 0; row < kMapSize; ++row) {
    if (down[row] <= 0.0f) continue;
    for (int i = 0; i < kMapSize; ++i) overlap[row * kMapSize + i] += down[row] * across[i];
  }
}

/// Sums sixteen rows into the rows of the parent that `along` gives: a row of `out` for
/// each of along.first .. along.last, and no others.
inline void sum_rows(const AxisResampling& along, const float* in, bool transmittance, float* out) {
  const Row zero{}, one = zero + 1.0f;
  Row sum = zero, carried = zero;
  int cell = along.first;
  for (int q = 0; q < kMapSize; ++q) {
    for (; cell < along.cell[q]; ++cell) {
      store_row(out + cell * kMapSize, sum);
      sum = carried;
      carried = zero;
    }
    Row row;
    load_row(in + q * kMapSize, row);
    if (transmittance) row = one - row;
    sum += row * along.here[q];
    carried += row * along.next[q];
  }
  store_row(out + cell * kMapSize, sum);
  if (cell < along.last) store_row(out + (cell + 1) * kMapSize, carried);
}

/// The child's opacity in the parent's cells, times the share of each that it covers.
/// Returns the rows touched; the others are not set.
DAPPLE_MULTIVERSION
std::pair<int, int> resample(const CoverageMap& child, int axis, const AxisResampling& across,
                             const AxisResampling& down, Cells& opacity) {
  // Down first, a row of child columns being one vector; then, turned, across.
  Cells rows, turned{}, columns;
  sum_rows(down, child.transmittance[axis].data(), true, rows.data());
  for (int j = down.first; j <= down.last; ++j) {
    for (int p = 0; p < kMapSize; ++p) turned[p * kMapSize + j] = rows[j * kMapSize + p];
  }
  sum_rows(across, turned.data(), false, columns.data());
  for (int j = down.first; j <= down.last; ++j) {
    float* out = &opacity[j * kMapSize];
    std::fill_n(out, kMapSize, 0.0f);
    for (int i = across.first; i <= across.last; ++i) out[i] = columns[i * kMapSize + j];
  }
  return {down.first, down.last};
}

/// How a child lies in its parent, along each axis. Axes along which the parent has no
/// size hold nothing of use.
struct ChildPlacement {
  AxisResampling cells[3];
  AxisShare share[3];
  ChildPlacement(const Box3f& parent, const Box3f& child)
      : cells{{parent, child, 0}, {parent, child, 1}, {parent, child, 2}},
        share{axis_share(parent, child, 0), axis_share(parent, child, 1),
              axis_share(parent, child, 2)} {}
};

/// Of a cell, boxes cover F and a child f; in the part that both cover, what they hide
/// overlaps as if independent, but for the `enclosed` share, which one of the two hides all of;
/// elsewhere not at all.
DAPPLE_MULTIVERSION
void merge_rows(int first, int last, const AxisShare& across, const AxisShare& down,
                const Cells& opacity, const Cells& overlap, float enclosed, Cells& map,
                Cells& map_covered) {
  for (int row = first; row <= last; ++row) {
    float* transmittance = &map[row * kMapSize];
    float* covered = &map_covered[row * kMapSize];
    const float* added = &opacity[row * kMapSize];
    const float* shared = &overlap[row * kMapSize];
    for (int i = 0; i < kMapSize; ++i) {
      const float f = down[row] * across[i];
      const float both = std::min(shared[i], std::min(f, covered[i]));
      const float hidden = 1.0f - transmittance[i];
      const float independent = hidden * added[i];
      const float smaller = std::min(hidden * f, added[i] * covered[i]);
      const float twice =
          both * (independent + enclosed * (smaller - independent)) / (covered[i] * f + 1e-20f);
      const float now =
          std::min(1.0f, hidden + added[i] - std::min(twice, std::min(hidden, added[i])));
      transmittance[i] = 1.0f - now;
      covered[i] = std::min(1.0f, covered[i] + f - both);
    }
  }
}

}  // namespace

DAPPLE_MULTIVERSION
void NodeCoverage::overlap_children(const Box3f& child_box, int axis, Cells& overlap) {
  overlap.fill(0.0f);
  for (int c = 0; c < child_count_; ++c) add_overlap(box_, children_[c], child_box, axis, overlap);
}

DAPPLE_MULTIVERSION
void NodeCoverage::add(const CoverageMap& child, const Box3f& child_box,
                       const SurfaceAreas& areas) {
  const ChildPlacement placement(box_, child_box);
  Cells opacity, overlap;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(box_, axis) > 0.0f)) continue;
    const int u = column_axis(axis), v = row_axis(axis);
    overlap_children(child_box, axis, overlap);
    const auto [first, last] =
        resample(child, axis, placement.cells[u], placement.cells[v], opacity);
    merge_rows(first, last, placement.share[u], placement.share[v], opacity, overlap,
               enclosed_share(areas_, areas, axis), map_.transmittance[axis], covered_[axis]);
  }
  areas_.add(areas);
  children_[child_count_++] = child_box;
}

DAPPLE_MULTIVERSION
void NodeCoverage::add_layer(std::span<const CoveringTriangle> triangles, const Box3f& child_box,
                             const SurfaceAreas& areas) {
  const AxisShare share[3] = {axis_share(box_, child_box, 0), axis_share(box_, child_box, 1),
                              axis_share(box_, child_box, 2)};
  CellCoverage coverage;
  HiddenCells cells;
  Cells overlap;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(box_, axis) > 0.0f)) continue;
    for (const CoveringTriangle& triangle : triangles) {
      CellTriangle projected;
      if (!project(triangle, box_, axis, projected)) continue;
      rasterize(projected, coverage);
      cells.add_uniform(projected, coverage, triangle.opacity);
    }
    overlap_children(child_box, axis, overlap);
    merge_rows(cells.row0, cells.row1, share[column_axis(axis)], share[row_axis(axis)],
               cells.hidden, overlap, enclosed_share(areas_, areas, axis), map_.transmittance[axis],
               covered_[axis]);
    cells.clear();
  }
  areas_.add(areas);
  children_[child_count_++] = child_box;
}

}  // namespace dapple
