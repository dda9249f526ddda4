#include "bvh/coverage_map.hpp"

#include <cmath>
#include <numeric>

#include "bvh/multiversion.hpp"

namespace dapple {
namespace {

constexpr float kSize = kMapSize;
/// Of scaling a triangle's cells to its area; two bring nearly all to a rounding.
constexpr int kScalingPasses = 3;

/// Where each cell of a child's axis lands in its parent's: a first cell, and how much of
/// a parent cell's width goes to it and to the next.
struct AxisResampling {
  std::array<int, kMapSize> cell;
  std::array<float, kMapSize> here, next;
  int first, last;  ///< parent cells touched

  AxisResampling(float parent_min, float parent_size, float child_min, float child_size) {
    const float to_cells = kSize / parent_size;
    const float start = std::clamp((child_min - parent_min) * to_cells, 0.0f, kSize);
    const float width = std::min(child_size * to_cells, kSize - start) / kSize;
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

AxisResampling resampling(const Box3f& parent, const Box3f& child, int axis) {
  return {parent.min[axis], parent.max[axis] - parent.min[axis], child.min[axis],
          child.max[axis] - child.min[axis]};
}

/// A triangle that slipped between the cells: its area shared by the cells it touches.
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

/// Cells that are full stay full; the others are scaled so that the sum is the triangle's
/// area. True when that filled more cells, so that another pass would come closer.
DAPPLE_MULTIVERSION
bool scale_partial_cells(const CellTriangle& triangle, CellCoverage& coverage) {
  std::array<float, kMapSize> full{}, partial{}, largest{};
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    const float* in = &coverage.share[row * kMapSize];
    for (int i = 0; i < kMapSize; ++i) {
      const bool is_full = in[i] >= 1.0f;
      const float rest = is_full ? 0.0f : in[i];
      full[i] += is_full ? 1.0f : 0.0f;
      partial[i] += rest;
      largest[i] = std::max(largest[i], rest);
    }
  }
  const float full_sum = std::accumulate(full.begin(), full.end(), 0.0f);
  const float partial_sum = std::accumulate(partial.begin(), partial.end(), 0.0f);
  if (full_sum + partial_sum <= 0.0f) {
    spread_evenly(triangle, coverage);
    return false;
  }
  if (partial_sum <= 0.0f) return false;
  const float scale = std::max(0.0f, triangle.area - full_sum) / partial_sum;
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    float* out = &coverage.share[row * kMapSize];
    for (int i = 0; i < kMapSize; ++i)
      out[i] = out[i] >= 1.0f ? 1.0f : std::min(1.0f, out[i] * scale);
  }
  return *std::max_element(largest.begin(), largest.end()) * scale > 1.0f;
}

}  // namespace

DAPPLE_MULTIVERSION
float CoverageMap::mean_opacity(int axis) const {
  const auto& map = transmittance[axis];
  std::array<float, kMapSize> columns{};
  for (int row = 0; row < kMapSize; ++row) {
    for (int i = 0; i < kMapSize; ++i) columns[i] += map[row * kMapSize + i];
  }
  return 1.0f - std::accumulate(columns.begin(), columns.end(), 0.0f) / kMapCells;
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

DAPPLE_MULTIVERSION
void rasterize(const CellTriangle& triangle, CellCoverage& coverage) {
  // Each edge cuts a share 1 - c from a cell; where the shares don't overlap, as in a thin
  // sliver or along an edge, what is left is c0 + c1 + c2 - 2. The rest is put right by
  // scaling to the known area. Rows are done whole: one or two vectors, no remainders.
  V2f corner[3] = {triangle.a, triangle.a + triangle.edge1, triangle.a + triangle.edge2};
  if (triangle.edge1.x * triangle.edge2.y < triangle.edge1.y * triangle.edge2.x)
    std::swap(corner[1], corner[2]);
  float nx[3], ny[3], offset[3];
  for (int e = 0; e < 3; ++e) {
    const V2f from = corner[e], along = corner[(e + 1) % 3] - from;
    const float reach = std::fabs(along.x) + std::fabs(along.y);
    const float inverse = reach > 0.0f ? 1.0f / reach : 0.0f;
    nx[e] = -along.y * inverse;
    ny[e] = along.x * inverse;
    offset[e] = reach > 0.0f ? 0.5f - nx[e] * from.x - ny[e] * from.y : 1.0f;
  }
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    float* out = &coverage.share[row * kMapSize];
    const float start0 = offset[0] + ny[0] * y, start1 = offset[1] + ny[1] * y,
                start2 = offset[2] + ny[2] * y;
    for (int i = 0; i < kMapSize; ++i) {
      const float x = static_cast<float>(i) + 0.5f;
      const float c0 = std::min(std::max(start0 + nx[0] * x, 0.0f), 1.0f);
      const float c1 = std::min(std::max(start1 + nx[1] * x, 0.0f), 1.0f);
      const float c2 = std::min(std::max(start2 + nx[2] * x, 0.0f), 1.0f);
      out[i] = std::max(0.0f, c0 + c1 + c2 - 2.0f);
    }
  }
  for (int pass = 0; pass < kScalingPasses && scale_partial_cells(triangle, coverage); ++pass) {
  }
}

DAPPLE_MULTIVERSION
void multiply_uniform(std::array<float, kMapCells>& map, const CellTriangle& triangle,
                      const CellCoverage& coverage, float opacity) {
  for (int row = triangle.row0; row <= triangle.row1; ++row) {
    float* out = &map[row * kMapSize];
    const float* in = &coverage.share[row * kMapSize];
    for (int i = 0; i < kMapSize; ++i) out[i] *= 1.0f - opacity * in[i];
  }
}

DAPPLE_MULTIVERSION
void composite(CoverageMap& parent, const Box3f& parent_box, const CoverageMap& child,
               const Box3f& child_box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(face_area(parent_box, axis) > 0.0f)) continue;
    const AxisResampling across = resampling(parent_box, child_box, column_axis(axis));
    const AxisResampling down = resampling(parent_box, child_box, row_axis(axis));
    // Opacity summed into the parent's rows first, child columns kept: one vector a row.
    std::array<std::array<float, kMapSize>, kMapSize + 1> rows{};
    for (int q = 0; q < kMapSize; ++q) {
      const float* in = &child.transmittance[axis][q * kMapSize];
      auto& here = rows[down.cell[q]];
      auto& next = rows[down.cell[q] + 1];
      for (int p = 0; p < kMapSize; ++p) {
        const float opacity = 1.0f - in[p];
        here[p] += down.here[q] * opacity;
        next[p] += down.next[q] * opacity;
      }
    }
    for (int j = down.first; j <= down.last; ++j) {
      std::array<float, kMapSize + 1> sums{};
      for (int p = 0; p < kMapSize; ++p) {
        sums[across.cell[p]] += across.here[p] * rows[j][p];
        sums[across.cell[p] + 1] += across.next[p] * rows[j][p];
      }
      float* out = &parent.transmittance[axis][j * kMapSize];
      for (int i = across.first; i <= across.last; ++i) out[i] *= 1.0f - std::min(1.0f, sums[i]);
    }
  }
}

void composite_uniform(CoverageMap& parent, const Box3f& parent_box, const V3f& opacity,
                       const Box3f& child_box) {
  CoverageMap child;
  for (int axis = 0; axis < 3; ++axis) child.transmittance[axis].fill(1.0f - opacity[axis]);
  composite(parent, parent_box, child, child_box);
}

}  // namespace dapple
