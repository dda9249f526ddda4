// Composites the coverage maps of children into the map of their parent.
#include <algorithm>
#include <cmath>

#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/map_row.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;

/// 0 where a side is so short that the number would overflow: it counts as having no length.
DAPPLE_ALWAYS_INLINE float cells_per_metre(const Box3f& parent, int axis) {
  const float side = parent.max[axis] - parent.min[axis];
  return side > 1e-30f ? kSize / side : 0.0f;
}

/// Resampling of a map of a child to the cells of its parent along one axis. For each cell of the
/// child: the first parent cell that it overlaps, and the overlap with this cell (`here`) and with
/// the next one, in widths of a parent cell.
struct AxisResampling {
  std::array<int, kMapSize> cell;
  std::array<float, kMapSize> here, next;
  int first, last;  ///< parent cells touched

  DAPPLE_ALWAYS_INLINE AxisResampling(const Box3f& parent, const Box3f& child, int axis) {
    const float to_cells = cells_per_metre(parent, axis);
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

/// Returns the share of each parent cell, along one axis, that lies in the range.
template <int kLanes>
DAPPLE_ALWAYS_INLINE Row<kLanes> cell_shares(const CellRange& range) {
  const auto begin = Row<kLanes>::indices();
  return max(min(begin + 1.0f, range.to) - max(begin, range.from), Row<kLanes>::zero());
}

/// Returns the share of a row of parent cells that lies in the range.
DAPPLE_ALWAYS_INLINE float row_share(const CellRange& range, int row) {
  const float y = static_cast<float>(row);
  return std::max(0.0f, std::min(range.to, y + 1.0f) - std::max(range.from, y));
}

CellRange cell_range(const Box3f& parent, const Box3f& box, int axis) {
  const float to_cells = cells_per_metre(parent, axis);
  return {(box.min[axis] - parent.min[axis]) * to_cells,
          (box.max[axis] - parent.min[axis]) * to_cells};
}

DAPPLE_ALWAYS_INLINE CellRange intersection(const CellRange& a, const CellRange& b) {
  return {std::max(a.from, b.from), std::min(a.to, b.to)};
}

using Cells = std::array<float, kMapCells>;

/// A range of rows, inclusive.
struct Rows {
  int first = kMapSize, last = -1;
};

/// Adds to `overlap` the share of each cell that both boxes cover, for the rows `within`. Extends
/// `touched`, the rows that the calls so far added to; the first of them sets all rows to 0.
template <int kLanes>
DAPPLE_ALWAYS_INLINE void add_overlap(const CellRanges& a, const CellRanges& b, int axis,
                                      const Rows& within, Cells& overlap, Rows& touched) {
  const CellRange columns = intersection(a[column_axis(axis)], b[column_axis(axis)]);
  const CellRange rows = intersection(a[row_axis(axis)], b[row_axis(axis)]);
  if (columns.from >= columns.to || rows.from >= rows.to) return;
  if (touched.last < 0) {
    for (int row = within.first; row <= within.last; ++row) {
      Row<kLanes>().store(&overlap[row * kMapSize]);
    }
  }
  const auto across = cell_shares<kLanes>(columns);
  const int first = std::max(within.first, static_cast<int>(rows.from));
  const int last = std::min(within.last, static_cast<int>(rows.to));
  for (int row = first; row <= last; ++row) {
    float* cells = &overlap[row * kMapSize];
    (Row<kLanes>::load(cells) + across * row_share(rows, row)).store(cells);
  }
  touched = {std::min(touched.first, first), std::max(touched.last, last)};
}

/// Sums the opacities of the child's sixteen rows into the parent's rows by `along`. Writes the
/// rows along.first .. along.last of `out`, and no others.
template <int kLanes>
DAPPLE_ALWAYS_INLINE void sum_rows(const AxisResampling& along, const float* transmittance,
                                   float* out) {
  Row<kLanes> sum, carried;
  int cell = along.first;
  for (int q = 0; q < kMapSize; ++q) {
    for (; cell < along.cell[q]; ++cell) {
      sum.store(out + cell * kMapSize);
      sum = carried;
      carried = {};
    }
    const Row<kLanes> opacity = Row<kLanes>(1.0f) - Row<kLanes>::load(transmittance + q * kMapSize);
    sum += opacity * along.here[q];
    carried += opacity * along.next[q];
  }
  sum.store(out + cell * kMapSize);
  if (cell < along.last) carried.store(out + (cell + 1) * kMapSize);
}

/// Computes the child's opacity in the parent's cells, times the share of each cell that the child
/// covers. Returns the rows touched; the others are not set.
template <int kLanes>
DAPPLE_ALWAYS_INLINE Rows resample(const CoverageMap& child, int axis, const AxisResampling& across,
                                   const AxisResampling& down, Cells& opacity) {
  // First down: a vector is a row of the child's columns. Then across: a vector is a row of the
  // parent's columns.
  Cells rows;
  sum_rows<kLanes>(down, child.transmittance[axis].data(), rows.data());
  Cells shares;
  const auto columns = Row<kLanes>::indices();
  for (int p = 0; p < kMapSize; ++p) {
    const auto cell = static_cast<float>(across.cell[p]);
    (where_equal(columns, cell, across.here[p]) + where_equal(columns, cell + 1.0f, across.next[p]))
        .store(&shares[p * kMapSize]);
  }
  for (int j = down.first; j <= down.last; ++j) {
    Row<kLanes> even, odd;
    for (int p = 0; p < kMapSize; p += 2) {
      even += Row<kLanes>::load(&shares[p * kMapSize]) * rows[j * kMapSize + p];
      odd += Row<kLanes>::load(&shares[(p + 1) * kMapSize]) * rows[j * kMapSize + p + 1];
    }
    (even + odd).store(&opacity[j * kMapSize]);
  }
  return {down.first, down.last};
}

/// Merges the child's `opacity` into `map`, and its box into `map_covered`. Earlier boxes cover a
/// share F of a cell, the child's box covers f. Occluded areas overlap only in the part that both
/// cover. There they count as independent, except for the share `enclosed`: in it the larger
/// occluded area contains the smaller.
template <int kLanes>
DAPPLE_ALWAYS_INLINE void merge_rows(const Rows& rows, const CellRanges& child, int axis,
                                     const Cells& opacity, const Cells& overlap,
                                     const Rows& overlapped, float enclosed, Cells& map,
                                     Cells& map_covered) {
  const auto one = Row<kLanes>::one();
  const auto across = cell_shares<kLanes>(child[column_axis(axis)]);
  for (int row = rows.first; row <= rows.last; ++row) {
    const int at = row * kMapSize;
    const Row<kLanes> f = across * row_share(child[row_axis(axis)], row);
    const Row<kLanes> occluded = one - Row<kLanes>::load(&map[at]);
    const auto covered = Row<kLanes>::load(&map_covered[at]);
    const auto added = Row<kLanes>::load(&opacity[at]);
    Row<kLanes> now = occluded + added, all = covered + f;
    if (row >= overlapped.first && row <= overlapped.last) {
      const Row<kLanes> both = min(min(Row<kLanes>::load(&overlap[at]), f), covered);
      const Row<kLanes> independent = occluded * added;
      const Row<kLanes> smaller = min(occluded * f, added * covered);
      const Row<kLanes> twice =
          both * (independent + (smaller - independent) * enclosed) / (covered * f + 1e-20f);
      now -= min(min(twice, occluded), added);
      all -= both;
    }
    (one - min(now, one)).store(&map[at]);
    min(all, one).store(&map_covered[at]);
  }
}

}  // namespace

CellRanges NodeCoverage::cell_ranges(const Box3f& child) const {
  return {cell_range(box_, child, 0), cell_range(box_, child, 1), cell_range(box_, child, 2)};
}

void NodeCoverage::merge(const CellRanges& child, int axis, int first_row, int last_row,
                         const Cells& opacity, const SurfaceAreas& areas) {
  const float enclosed = enclosed_share(areas_, areas, axis);
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    const Rows rows{first_row, last_row};
    Cells overlap;
    Rows overlapped;
    for (int c = 0; c < child_count_; ++c) {
      add_overlap<kLanes>(children_[c], child, axis, rows, overlap, overlapped);
    }
    merge_rows<kLanes>(rows, child, axis, opacity, overlap, overlapped, enclosed,
                       map_.transmittance[axis], covered_[axis]);
  });
}

void NodeCoverage::add(const CoverageMap& child, const Box3f& child_box,
                       const SurfaceAreas& areas) {
  const CellRanges ranges = cell_ranges(child_box);
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    const AxisResampling cells[3] = {
        {box_, child_box, 0}, {box_, child_box, 1}, {box_, child_box, 2}};
    Cells opacity;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(face_area(box_, axis) > 0.0f)) continue;
      const Rows rows =
          resample<kLanes>(child, axis, cells[column_axis(axis)], cells[row_axis(axis)], opacity);
      merge(ranges, axis, rows.first, rows.last, opacity, areas);
    }
  });
  areas_.add(areas);
  children_[child_count_++] = ranges;
}

void NodeCoverage::add_uniform(const V3f& opacity, const Box3f& child_box) {
  const CellRanges ranges = cell_ranges(child_box);
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    Cells cells;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(face_area(box_, axis) > 0.0f)) continue;
      const auto across = cell_shares<kLanes>(ranges[column_axis(axis)]) * opacity[axis];
      const CellRange& rows = ranges[row_axis(axis)];
      const int first = std::clamp(static_cast<int>(rows.from), 0, kMapSize - 1);
      const int last = std::clamp(static_cast<int>(rows.to), 0, kMapSize - 1);
      for (int row = first; row <= last; ++row)
        (across * row_share(rows, row)).store(&cells[row * kMapSize]);
      merge(ranges, axis, first, last, cells, {});
    }
  });
  children_[child_count_++] = ranges;
}

void NodeCoverage::add_layer(const Covering& covering, const SharedEdges& edges,
                             const Box3f& child_box, const SurfaceAreas& areas) {
  const CellRanges ranges = cell_ranges(child_box);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(box_, axis) > 0.0f)) continue;
    const LeafView leaf{covering[axis], edges, box_, axis};
    std::uint32_t done = 0;
    for (std::size_t t = 0; t < leaf.triangles.size(); ++t) {
      if (!(done >> t & 1u)) done = layer_.draw(leaf, t, done);
    }
    merge(ranges, axis, layer_.row0, layer_.row1, layer_.occluded, areas);
    layer_.clear();
  }
  areas_.add(areas);
  children_[child_count_++] = ranges;
}

}  // namespace dapple
