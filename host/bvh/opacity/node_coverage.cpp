// Composites the coverage maps of children into the map of their parent.
#include <algorithm>
#include <cmath>

#include "bvh/build/multiversion.hpp"
#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/map_row.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;

/// Resampling of a map of a child to the cells of its parent along one axis. For each cell of the
/// child: the first parent cell that it overlaps, and the overlap with this cell (`here`) and with
/// the next one, in widths of a parent cell.
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

/// Computes the share of each parent cell, along one axis, that lies in the range.
inline void cell_shares(const CellRange& range, Row& share) {
  const Row zero{};
  Row begin;
  for (int i = 0; i < kMapSize; ++i) begin[i] = static_cast<float>(i);
  const Row end = begin + 1.0f, from = zero + range.from, to = zero + range.to;
  const Row width = (to < end ? to : end) - (from > begin ? from : begin);
  share = width > zero ? width : zero;
}

CellRange cell_range(const Box3f& parent, const Box3f& box, int axis) {
  const float to_cells = kSize / (parent.max[axis] - parent.min[axis]);
  return {(box.min[axis] - parent.min[axis]) * to_cells,
          (box.max[axis] - parent.min[axis]) * to_cells};
}

CellRange intersection(const CellRange& a, const CellRange& b) {
  return {std::max(a.from, b.from), std::min(a.to, b.to)};
}

using Cells = std::array<float, kMapCells>;

/// A range of rows, inclusive.
struct Rows {
  int first = kMapSize, last = -1;
};

/// Adds to `overlap` the share of each cell that both boxes cover, for the rows `within`. Extends
/// `touched`, the rows that the calls so far added to; the first of them sets all rows to 0.
inline void add_overlap(const CellRanges& a, const CellRanges& b, int axis, const Rows& within,
                        Cells& overlap, Rows& touched) {
  const CellRange columns = intersection(a[column_axis(axis)], b[column_axis(axis)]);
  const CellRange rows = intersection(a[row_axis(axis)], b[row_axis(axis)]);
  if (columns.from >= columns.to || rows.from >= rows.to) return;
  if (touched.last < 0) {
    for (int row = within.first; row <= within.last; ++row) {
      store_row(&overlap[row * kMapSize], Row{});
    }
  }
  Row across, sum;
  cell_shares(columns, across);
  const int first = std::max(within.first, static_cast<int>(rows.from));
  const int last = std::min(within.last, static_cast<int>(rows.to));
  for (int row = first; row <= last; ++row) {
    const float y = static_cast<float>(row);
    const float down = std::max(0.0f, std::min(rows.to, y + 1.0f) - std::max(rows.from, y));
    load_row(&overlap[row * kMapSize], sum);
    sum += across * down;
    store_row(&overlap[row * kMapSize], sum);
  }
  touched = {std::min(touched.first, first), std::max(touched.last, last)};
}

/// Sums the opacities of the child's sixteen rows into the parent's rows by `along`. Writes the
/// rows along.first .. along.last of `out`, and no others.
inline void sum_rows(const AxisResampling& along, const float* transmittance, float* out) {
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
    load_row(transmittance + q * kMapSize, row);
    row = one - row;
    sum += row * along.here[q];
    carried += row * along.next[q];
  }
  store_row(out + cell * kMapSize, sum);
  if (cell < along.last) store_row(out + (cell + 1) * kMapSize, carried);
}

/// Computes the child's opacity in the parent's cells, times the share of each cell that the child
/// covers. Returns the rows touched; the others are not set.
DAPPLE_MULTIVERSION
Rows resample(const CoverageMap& child, int axis, const AxisResampling& across,
              const AxisResampling& down, Cells& opacity) {
  // First down: a vector is a row of the child's columns. Then across: a vector is a row of the
  // parent's columns.
  Cells rows;
  sum_rows(down, child.transmittance[axis].data(), rows.data());
  Cells shares;
  const Row zero{};
  Row column;
  for (int i = 0; i < kMapSize; ++i) column[i] = static_cast<float>(i);
  for (int p = 0; p < kMapSize; ++p) {
    const float cell = static_cast<float>(across.cell[p]);
    const Row here = column == zero + cell ? zero + across.here[p] : zero;
    const Row next = column == zero + (cell + 1.0f) ? zero + across.next[p] : zero;
    store_row(&shares[p * kMapSize], here + next);
  }
  for (int j = down.first; j <= down.last; ++j) {
    Row even{}, odd{}, share;
    for (int p = 0; p < kMapSize; p += 2) {
      load_row(&shares[p * kMapSize], share);
      even += share * rows[j * kMapSize + p];
      load_row(&shares[(p + 1) * kMapSize], share);
      odd += share * rows[j * kMapSize + p + 1];
    }
    store_row(&opacity[j * kMapSize], even + odd);
  }
  return {down.first, down.last};
}

/// Merges the child's `opacity` into `map`, and its box into `map_covered`. Earlier boxes cover a
/// share F of a cell, the child's box covers f. Occluded areas overlap only in the part that both
/// cover. There they count as independent, except for the share `enclosed`: in it the larger
/// occluded area contains the smaller.
DAPPLE_MULTIVERSION
void merge_rows(const Rows& rows, const CellRanges& child, int axis, const Cells& opacity,
                const Cells& overlap, const Rows& overlapped, float enclosed, Cells& map,
                Cells& map_covered) {
  const Row zero{}, one = zero + 1.0f;
  Row across;
  cell_shares(child[column_axis(axis)], across);
  const CellRange down = child[row_axis(axis)];
  for (int row = rows.first; row <= rows.last; ++row) {
    const float y = static_cast<float>(row);
    const Row f = across * std::max(0.0f, std::min(down.to, y + 1.0f) - std::max(down.from, y));
    Row transmittance, covered, added;
    load_row(&map[row * kMapSize], transmittance);
    load_row(&map_covered[row * kMapSize], covered);
    load_row(&opacity[row * kMapSize], added);
    const Row occluded = one - transmittance;
    Row now = occluded + added, all = covered + f;
    if (row >= overlapped.first && row <= overlapped.last) {
      Row both;
      load_row(&overlap[row * kMapSize], both);
      keep_min(both, f);
      keep_min(both, covered);
      const Row independent = occluded * added;
      Row smaller = occluded * f;
      keep_min(smaller, added * covered);
      Row twice =
          both * (independent + enclosed * (smaller - independent)) / (covered * f + 1e-20f);
      keep_min(twice, occluded);
      keep_min(twice, added);
      now -= twice;
      all -= both;
    }
    keep_min(now, one);
    keep_min(all, one);
    store_row(&map[row * kMapSize], one - now);
    store_row(&map_covered[row * kMapSize], all);
  }
}

}  // namespace

CellRanges NodeCoverage::cell_ranges(const Box3f& child) const {
  return {cell_range(box_, child, 0), cell_range(box_, child, 1), cell_range(box_, child, 2)};
}

DAPPLE_MULTIVERSION
void NodeCoverage::merge(const CellRanges& child, int axis, int first_row, int last_row,
                         const Cells& opacity, const SurfaceAreas& areas) {
  const Rows rows{first_row, last_row};
  Cells overlap;
  Rows overlapped;
  for (int c = 0; c < child_count_; ++c) {
    add_overlap(children_[c], child, axis, rows, overlap, overlapped);
  }
  merge_rows(rows, child, axis, opacity, overlap, overlapped, enclosed_share(areas_, areas, axis),
             map_.transmittance[axis], covered_[axis]);
}

DAPPLE_MULTIVERSION
void NodeCoverage::add(const CoverageMap& child, const Box3f& child_box,
                       const SurfaceAreas& areas) {
  const CellRanges ranges = cell_ranges(child_box);
  const AxisResampling cells[3] = {
      {box_, child_box, 0}, {box_, child_box, 1}, {box_, child_box, 2}};
  Cells opacity;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(box_, axis) > 0.0f)) continue;
    const Rows rows =
        resample(child, axis, cells[column_axis(axis)], cells[row_axis(axis)], opacity);
    merge(ranges, axis, rows.first, rows.last, opacity, areas);
  }
  areas_.add(areas);
  children_[child_count_++] = ranges;
}

void NodeCoverage::add_layer(const Covering& covering, const Box3f& child_box,
                             const SurfaceAreas& areas) {
  const CellRanges ranges = cell_ranges(child_box);
  CellCoverage coverage;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(box_, axis) > 0.0f)) continue;
    for (const CoveringTriangle& triangle : covering[axis]) {
      CellTriangle projected;
      if (!project(triangle, box_, axis, projected)) continue;
      rasterize(projected, coverage);
      layer_.add_uniform(projected, coverage, triangle.opacity);
    }
    merge(ranges, axis, layer_.row0, layer_.row1, layer_.occluded, areas);
    layer_.clear();
  }
  areas_.add(areas);
  children_[child_count_++] = ranges;
}

}  // namespace dapple
