#include "bvh/opacity/coverage_map.hpp"

#include <cmath>
#include <optional>

#include "bvh/opacity/map_row.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;
/// Polygons with a smaller area, in cells, occlude nothing.
constexpr float kLeastArea = 1e-6f;
/// Maximum number of passes that scale a polygon's cells to its area. After two, nearly all are
/// exact but for rounding.
constexpr int kScalingPasses = 3;

/// For a polygon whose coverage is rounded to 0 in every cell: divides its area equally over the
/// cells that it touches.
void spread_evenly(const CellPolygon& polygon, CellCoverage& coverage) {
  const int columns = polygon.column1 - polygon.column0 + 1, rows = polygon.row1 - polygon.row0 + 1;
  const float share = std::min(1.0f, polygon.area / static_cast<float>(columns * rows));
  for (int row = polygon.row0; row <= polygon.row1; ++row) {
    for (int column = 0; column < kMapSize; ++column) {
      const bool touched = column >= polygon.column0 && column <= polygon.column1;
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
  return max(min(share * scale, Row<kLanes>::one()), at_least(share, 1.0f));
}

/// Writes the shares that the edges leave of the cells in the touched rows.
template <int kLanes, int kEdges>
DAPPLE_ALWAYS_INLINE Tally<kLanes> cut_rows(const CellPolygon& polygon, CellCoverage& coverage) {
  // Each edge cuts a share 1 - c from a cell. If these shares do not overlap, as in a thin sliver
  // or along an edge, the share 1 less all 1 - c remains. Scaling to the known area corrects the
  // other cells. Whole rows are computed: full vectors without remainders.
  const V2f b = polygon.a + polygon.edge1, c = polygon.a + polygon.edge2;
  const bool clockwise = polygon.edge1.cross(polygon.edge2) < 0.0f;
  const V2f second(clockwise ? c.x : b.x, clockwise ? c.y : b.y);
  const V2f last(clockwise ? b.x : c.x, clockwise ? b.y : c.y);
  const V2f corner[4] = {polygon.a, second, kEdges == 4 ? polygon.a + polygon.fourth : last, last};
  float nx[kEdges], ny[kEdges], offset[kEdges];
  for (int e = 0; e < kEdges; ++e) {
    const V2f from = corner[e], along = corner[(e + 1) % kEdges] - from;
    const float reach = std::fabs(along.x) + std::fabs(along.y);
    const float inverse = reach > 0.0f ? 1.0f / reach : 0.0f;
    nx[e] = -along.y * inverse;
    ny[e] = along.x * inverse;
    offset[e] = reach > 0.0f ? 0.5f - nx[e] * from.x - ny[e] * from.y : 1.0f;
  }
  // Along a row the shares are linear; from one row to the next they change by ny.
  const Row<kLanes> x = Row<kLanes>::indices() + 0.5f;
  Row<kLanes> beyond[kEdges];
  const float y = static_cast<float>(polygon.row0) + 0.5f;
  for (int e = 0; e < kEdges; ++e) beyond[e] = x * nx[e] + (offset[e] + ny[e] * y);
  Tally<kLanes> tally;
  const auto zero = Row<kLanes>::zero(), one = Row<kLanes>::one();
  for (int row = polygon.row0; row <= polygon.row1; ++row) {
    Row<kLanes> left(1.0f - kEdges);
    for (int e = 0; e < kEdges; ++e) {
      left += min(max(beyond[e], zero), one);
      beyond[e] += ny[e];
    }
    left = max(left, zero);
    left.store(&coverage.share[row * kMapSize]);
    tally.add(left);
  }
  return tally;
}

/// rasterize() for registers of `kLanes` floats. Calls finish(row, shares) for each touched row.
template <int kLanes, class Finish>
DAPPLE_ALWAYS_INLINE void rasterize_rows(const CellPolygon& polygon, CellCoverage& coverage,
                                         const Finish& finish) {
  // Cells that are not full are scaled so that the sum over all cells is the polygon's area. Where
  // this fills more cells, another pass comes closer.
  auto tally = polygon.is_quad ? cut_rows<kLanes, 4>(polygon, coverage)
                               : cut_rows<kLanes, 3>(polygon, coverage);
  float scale = 1.0f;
  for (int pass = 1;; ++pass) {
    const float full = tally.full.sum(), partial = tally.partial.sum();
    if (full + partial <= 0.0f) spread_evenly(polygon, coverage);
    if (partial <= 0.0f) break;
    scale = std::max(0.0f, polygon.area - full) / partial;
    if (pass == kScalingPasses || !(tally.largest.max() * scale > 1.0f)) break;
    tally = {};
    for (int row = polygon.row0; row <= polygon.row1; ++row) {
      float* cells = &coverage.share[row * kMapSize];
      const auto share = scaled(Row<kLanes>::load(cells), scale);
      share.store(cells);
      tally.add(share);
    }
    scale = 1.0f;
  }
  for (int row = polygon.row0; row <= polygon.row1; ++row)
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

namespace {

/// Map cells per metre; none if the box has no area along the axis.
std::optional<V2f> map_scale(const Box3f& box, int axis) {
  const float width = box.max[column_axis(axis)] - box.min[column_axis(axis)];
  const float height = box.max[row_axis(axis)] - box.min[row_axis(axis)];
  if (!(width > 0.0f && height > 0.0f)) return std::nullopt;
  return V2f(kSize / width, kSize / height);
}

V2f seen_along(int axis, const V3f& v) { return V2f(v[column_axis(axis)], v[row_axis(axis)]); }

/// Sets the first and last cell between two places on a map.
void set_range(float low, float high, int& first, int& last) {
  first = std::clamp(static_cast<int>(low), 0, kMapSize - 1);
  last = std::clamp(static_cast<int>(high), first, kMapSize - 1);
}

}  // namespace

bool project(const CoveringTriangle& triangle, const Box3f& box, int axis, CellPolygon& out) {
  const std::optional<V2f> scale = map_scale(box, axis);
  if (!scale) return false;
  out.a = seen_along(axis, triangle.vertex - box.min) * *scale;
  out.edge1 = seen_along(axis, triangle.edge1) * *scale;
  out.edge2 = seen_along(axis, triangle.edge2) * *scale;
  out.is_quad = false;
  out.area = 0.5f * std::fabs(out.edge1.cross(out.edge2));
  if (!(out.area > kLeastArea)) return false;
  set_range(out.a.x + std::min({0.0f, out.edge1.x, out.edge2.x}),
            out.a.x + std::max({0.0f, out.edge1.x, out.edge2.x}), out.column0, out.column1);
  set_range(out.a.y + std::min({0.0f, out.edge1.y, out.edge2.y}),
            out.a.y + std::max({0.0f, out.edge1.y, out.edge2.y}), out.row0, out.row1);
  return true;
}

bool project_quad(const CoveringTriangle& triangle, const V3f& fourth, const Box3f& box, int axis,
                  CellPolygon& out) {
  if (!project(triangle, box, axis, out)) return false;
  const V2f scale = *map_scale(box, axis);
  const V2f &b = out.edge1, &c = out.edge2;
  const V2f d = out.fourth = seen_along(axis, fourth - triangle.vertex) * scale;
  // Convex: at b and at c the outline turns as it does at a.
  const float turn = b.cross(c), at_b = b.cross(d - b), at_c = (c - d).cross(-c);
  if (turn > 0.0f ? at_b < 0.0f || at_c < 0.0f : at_b > 0.0f || at_c > 0.0f) return false;
  out.is_quad = true;
  out.area = 0.5f * std::fabs((c - b).cross(d));
  set_range(out.a.x + std::min({0.0f, b.x, c.x, d.x}), out.a.x + std::max({0.0f, b.x, c.x, d.x}),
            out.column0, out.column1);
  set_range(out.a.y + std::min({0.0f, b.y, c.y, d.y}), out.a.y + std::max({0.0f, b.y, c.y, d.y}),
            out.row0, out.row1);
  return true;
}

void rasterize(const CellPolygon& polygon, CellCoverage& coverage) {
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    rasterize_rows<kLanes>(
        polygon, coverage, [&](int row, const Row<kLanes>& share) __attribute__((always_inline)) {
          share.store(&coverage.share[row * kMapSize]);
        });
  });
}

void OccludedCells::draw(const CellPolygon& polygon, float opacity) {
  row0 = std::min(row0, polygon.row0);
  row1 = std::max(row1, polygon.row1);
  for_register_width([&]<int kLanes>() __attribute__((always_inline)) {
    CellCoverage coverage;
    rasterize_rows<kLanes>(
        polygon, coverage, [&](int row, const Row<kLanes>& share) __attribute__((always_inline)) {
          float* cells = &occluded[row * kMapSize];
          (Row<kLanes>::load(cells) + share * opacity).store(cells);
        });
  });
}

std::uint32_t OccludedCells::draw(const LeafView& leaf, std::size_t t, std::uint32_t done) {
  const CoveringTriangle& triangle = leaf.triangles[t];
  const SharedEdges::Partner partner = leaf.edges.partner(leaf.axis, t);
  CellPolygon projected;
  done |= 1u << t;
  if (partner.triangle >= 0 && !(done >> partner.triangle & 1u)) {
    const auto other = static_cast<std::size_t>(partner.triangle);
    const V3f fourth =
        corner_of(leaf.triangles[other], leaf.edges.partner(leaf.axis, other).corner);
    if (project_quad(turned(triangle, partner.corner), fourth, leaf.box, leaf.axis, projected)) {
      draw(projected, triangle.opacity);
      return done | 1u << partner.triangle;
    }
  }
  if (project(triangle, leaf.box, leaf.axis, projected)) draw(projected, triangle.opacity);
  return done;
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
      const auto share = min(Row<kLanes>::load(&occluded[row * kMapSize]), Row<kLanes>::one());
      float* cells = &map[row * kMapSize];
      (Row<kLanes>::load(cells) * (Row<kLanes>(1.0f) - share)).store(cells);
    }
  });
  clear();
}

std::uint32_t draw_closed(const Box3f& box, std::span<const CoveringTriangle> triangles, int axis,
                          OccludedCells& cells, OccludedCells& back) {
  std::uint32_t done = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!triangles[t].closed) continue;
    done |= 1u << t;
    CellPolygon projected;
    if (!project(triangles[t], box, axis, projected)) continue;
    const bool faces_axis = triangles[t].edge1.cross(triangles[t].edge2)[axis] > 0.0f;
    (faces_axis ? cells : back).draw(projected, triangles[t].opacity);
  }
  cells.enclose(back);
  return done;
}

}  // namespace dapple
