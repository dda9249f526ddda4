#include "bvh/opacity/coverage_map.hpp"

#include <cmath>

#include "bvh/opacity/map_row.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;
/// Maximum number of passes that scale a triangle's cells to its area. After two, nearly all
/// triangles are exact but for rounding.
constexpr int kScalingPasses = 3;

/// For a triangle whose coverage is rounded to 0 in every cell: divides its area equally over the
/// cells that it touches.
void spread_evenly(const CellTriangle& triangle, CellCoverage& coverage) {
  const int columns = triangle.column1 - triangle.column0 + 1,
            rows = triangle.row1 - triangle.row0 + 1;
  const float share = std::min(1.0f, triangle.area / static_cast<float>(columns * rows));
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    for (int column = 0; column < kMapSize; ++column) {
      const bool touched = column >= triangle.column0 && column <= triangle.column1;
      coverage.share[row * kMapSize + column] = touched ? share : 0.0f;
    }
  }
}

/// By column, over the touched rows: the number of full cells, and the sum and the maximum of the
/// other cells.
template <int kLanes>
struct Tally {
  Row<kLanes> full, partial, largest;

  /// No cell of `in` is above 1.
  DAPPLE_ALWAYS_INLINE void add(const Row<kLanes>& in) {
    const Row<kLanes> filled = at_least(in, 1.0f), rest = in - filled;
    full += filled;
    partial += rest;
    largest = max(largest, rest);
  }
};

/// Scales cells that are not full.
template <int kLanes>
DAPPLE_ALWAYS_INLINE Row<kLanes> scaled(const Row<kLanes>& share, float scale) {
  return max(min(share * scale, 1.0f), at_least(share, 1.0f));
}

/// Writes the shares that the edges leave of the cells in the touched rows.
template <int kLanes>
DAPPLE_ALWAYS_INLINE Tally<kLanes> cut_rows(const CellTriangle& triangle, CellCoverage& coverage) {
  // Each edge cuts a share 1 - c from a cell. If these shares do not overlap, as in a thin sliver
  // or along an edge, the share c0 + c1 + c2 - 2 remains. Scaling to the known area corrects the
  // other cells. Whole rows are computed: full vectors without remainders.
  const V2f b = triangle.a + triangle.edge1, c = triangle.a + triangle.edge2;
  const bool turned = triangle.edge1.x * triangle.edge2.y < triangle.edge1.y * triangle.edge2.x;
  const V2f corner[3] = {triangle.a,
                         {turned ? c.x : b.x, turned ? c.y : b.y},
                         {turned ? b.x : c.x, turned ? b.y : c.y}};
  float nx[3], ny[3], offset[3];
  for (int e = 0; e < 3; ++e) {
    const V2f from = corner[e], along = corner[(e + 1) % 3] - from;
    const float reach = std::fabs(along.x) + std::fabs(along.y);
    const float inverse = reach > 0.0f ? 1.0f / reach : 0.0f;
    nx[e] = -along.y * inverse;
    ny[e] = along.x * inverse;
    offset[e] = reach > 0.0f ? 0.5f - nx[e] * from.x - ny[e] * from.y : 1.0f;
  }
  // Along a row the shares are linear; from one row to the next they change by ny.
  const Row<kLanes> x = Row<kLanes>::indices() + 0.5f;
  Row<kLanes> beyond[3];
  const float y = static_cast<float>(triangle.row0) + 0.5f;
  for (int e = 0; e < 3; ++e) beyond[e] = x * nx[e] + (offset[e] + ny[e] * y);
  Tally<kLanes> tally;
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    Row<kLanes> left(-2.0f);
    for (int e = 0; e < 3; ++e) {
      left += min(max(beyond[e], 0.0f), 1.0f);
      beyond[e] += ny[e];
    }
    left = max(left, 0.0f);
    left.store(&coverage.share[row * kMapSize]);
    tally.add(left);
  }
  return tally;
}

/// rasterize() for registers of `kLanes` floats. Calls finish(row, shares) for each touched row.
template <int kLanes, class Finish>
DAPPLE_ALWAYS_INLINE void rasterize_rows(const CellTriangle& triangle, CellCoverage& coverage,
                                         const Finish& finish) {
  // Cells that are not full are scaled so that the sum over all cells is the triangle's area. Where
  // this fills more cells, another pass comes closer.
  auto tally = cut_rows<kLanes>(triangle, coverage);
  float scale = 1.0f;
  for (int pass = 1;; ++pass) {
    const float full = tally.full.sum(), partial = tally.partial.sum();
    if (full + partial <= 0.0f) spread_evenly(triangle, coverage);
    if (partial <= 0.0f) break;
    scale = std::max(0.0f, triangle.area - full) / partial;
    if (pass == kScalingPasses || !(tally.largest.max() * scale > 1.0f)) break;
    tally = {};
    for (int row = triangle.row0; row <= triangle.row1; ++row) {
      float* cells = &coverage.share[row * kMapSize];
      const auto share = scaled(Row<kLanes>::load(cells), scale);
      share.store(cells);
      tally.add(share);
    }
    scale = 1.0f;
  }
  for (int row = triangle.row0; row <= triangle.row1; ++row)
    finish(row, scaled(Row<kLanes>::load(&coverage.share[row * kMapSize]), scale));
}

}  // namespace

void fill_cells(std::array<float, kMapCells>& cells, float value) {
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    for (int row = 0; row < kMapSize; ++row) Row<kLanes>(value).store(&cells[row * kMapSize]);
  });
}

float CoverageMap::mean_opacity(int axis) const {
  float mean = 0;
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    Row<kLanes> sum;
    for (int row = 0; row < kMapSize; ++row) {
      sum += Row<kLanes>::load(&transmittance[axis][row * kMapSize]);
    }
    mean = sum.sum() / kMapCells;
  });
  return 1.0f - mean;
}

MapStatistics CoverageMap::statistics() const {
  MapStatistics out{};
  float variance = 0, greatest = 0;
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    constexpr float kScale = 2.0f / kMapSize;
    const Row<kLanes> x = (Row<kLanes>::indices() + 0.5f) * kScale - 1.0f;
    const Row<kLanes> x2 = x * x;
    for (int axis = 0; axis < 3; ++axis) {
      Row<kLanes> sum, squares, columns, rows, distances;
      for (int row = 0; row < kMapSize; ++row) {
        const auto t = Row<kLanes>::load(&transmittance[axis][row * kMapSize]);
        const float y = (static_cast<float>(row) + 0.5f) * kScale - 1.0f;
        const Row<kLanes> opacity = Row<kLanes>(1.0f) - t;
        sum += t;
        squares += t * t;
        columns += opacity * x;
        rows += opacity * y;
        distances += opacity * (x2 + y * y);
      }
      const float mean = sum.sum() / kMapCells;
      out.opacity[axis] = 1.0f - mean;
      out.moments[axis] = {columns.sum() / kMapCells, rows.sum() / kMapCells,
                           distances.sum() / kMapCells};
      variance += std::max(0.0f, squares.sum() / kMapCells - mean * mean);
      greatest += std::max(0.0f, mean * (1.0f - mean));
    }
  });
  out.clumping = greatest > 1e-6f ? std::min(1.0f, variance / greatest) : 0.0f;
  return out;
}

bool project(const CoveringTriangle& triangle, const Box3f& box, int axis, CellTriangle& out) {
  const int u = column_axis(axis), v = row_axis(axis);
  const float width = box.max[u] - box.min[u], height = box.max[v] - box.min[v];
  if (!(width > 0.0f && height > 0.0f)) return false;
  const V2f scale(kSize / width, kSize / height);
  out.a = V2f(triangle.vertex[u] - box.min[u], triangle.vertex[v] - box.min[v]) * scale;
  out.edge1 = V2f(triangle.edge1[u], triangle.edge1[v]) * scale;
  out.edge2 = V2f(triangle.edge2[u], triangle.edge2[v]) * scale;
  out.area = 0.5f * std::fabs(out.edge1.x * out.edge2.y - out.edge1.y * out.edge2.x);
  if (!(out.area > 1e-6f)) return false;
  const auto range = [](float base, float e1, float e2, int& first, int& last) {
    const float low = base + std::min({0.0f, e1, e2}), high = base + std::max({0.0f, e1, e2});
    first = std::clamp(static_cast<int>(low), 0, kMapSize - 1);
    last = std::clamp(static_cast<int>(high), first, kMapSize - 1);
  };
  range(out.a.x, out.edge1.x, out.edge2.x, out.column0, out.column1);
  range(out.a.y, out.edge1.y, out.edge2.y, out.row0, out.row1);
  return true;
}

void rasterize(const CellTriangle& triangle, CellCoverage& coverage) {
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    rasterize_rows<kLanes>(
        triangle, coverage, [&](int row, const Row<kLanes>& share) __attribute__((always_inline)) {
          share.store(&coverage.share[row * kMapSize]);
        });
  });
}

void OccludedCells::draw(const CellTriangle& triangle, float opacity) {
  row0 = std::min(row0, triangle.row0);
  row1 = std::max(row1, triangle.row1);
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    CellCoverage coverage;
    rasterize_rows<kLanes>(
        triangle, coverage, [&](int row, const Row<kLanes>& share) __attribute__((always_inline)) {
          float* cells = &occluded[row * kMapSize];
          (Row<kLanes>::load(cells) + share * opacity).store(cells);
        });
  });
}

void OccludedCells::clear() {
  for (int cell = row0 * kMapSize; cell < (row1 + 1) * kMapSize; ++cell) occluded[cell] = 0.0f;
  row0 = kMapSize;
  row1 = -1;
}

void OccludedCells::enclose(OccludedCells& back) {
  for (int cell = back.row0 * kMapSize; cell < (back.row1 + 1) * kMapSize; ++cell) {
    occluded[cell] = std::max(occluded[cell], back.occluded[cell]);
  }
  row0 = std::min(row0, back.row0);
  row1 = std::max(row1, back.row1);
  back.clear();
}

void OccludedCells::flush(std::array<float, kMapCells>& map) {
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    for (int row = row0; row <= row1; ++row) {
      const auto share = min(Row<kLanes>::load(&occluded[row * kMapSize]), 1.0f);
      float* cells = &map[row * kMapSize];
      (Row<kLanes>::load(cells) * (Row<kLanes>(1.0f) - share)).store(cells);
    }
  });
  clear();
}

std::uint64_t draw_closed(const Box3f& box, std::span<const CoveringTriangle> triangles, int axis,
                          OccludedCells& cells, OccludedCells& back) {
  std::uint64_t done = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!triangles[t].closed) continue;
    done |= std::uint64_t{1} << t;
    CellTriangle projected;
    if (!project(triangles[t], box, axis, projected)) continue;
    const bool faces_axis = triangles[t].edge1.cross(triangles[t].edge2)[axis] > 0.0f;
    (faces_axis ? cells : back).draw(projected, triangles[t].opacity);
  }
  cells.enclose(back);
  return done;
}

unsigned side_by_side(const CoveringTriangle& a, const CoveringTriangle& b) {
  const V3f p[3] = {a.vertex, a.vertex + a.edge1, a.vertex + a.edge2};
  const V3f q[3] = {b.vertex, b.vertex + b.edge1, b.vertex + b.edge2};
  // Stored edges are rounded: corners that were equal may differ by a few roundings.
  const float tolerance =
      1e-5f * (std::fabs(a.edge1.x) + std::fabs(a.edge1.y) + std::fabs(a.edge1.z) +
               std::fabs(a.edge2.x) + std::fabs(a.edge2.y) + std::fabs(a.edge2.z));
  int shared[2][2], count = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (count < 2 && p[i].equalWithAbsError(q[j], tolerance)) {
        shared[count][0] = i;
        shared[count++][1] = j;
      }
    }
  }
  if (count < 2 || shared[0][0] == shared[1][0] || shared[0][1] == shared[1][1]) return 0;
  const V3f& from = p[shared[0][0]];
  const V3f edge = p[shared[1][0]] - from;
  const V3f third_a = p[3 - shared[0][0] - shared[1][0]] - from;
  const V3f third_b = q[3 - shared[0][1] - shared[1][1]] - from;
  const V3f turn_a = edge.cross(third_a), turn_b = edge.cross(third_b);
  unsigned axes = 0;
  for (int axis = 0; axis < 3; ++axis) axes |= unsigned{turn_a[axis] * turn_b[axis] < 0.0f} << axis;
  return axes;
}

bool is_single_layer(std::span<const CoveringTriangle> triangles) {
  for (std::size_t t = 1; t < triangles.size(); ++t) {
    unsigned axes = 0;
    for (std::size_t other = 0; other < t && axes != 7u; ++other)
      axes |= side_by_side(triangles[other], triangles[t]);
    if (axes != 7u) return false;
  }
  return true;
}

}  // namespace dapple
