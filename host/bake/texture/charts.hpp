// Divides a mesh into charts: connected triangles that one plane shows without overlaps. In: a
// mesh. Out: flat coordinates of the triangles. Foliage has a chart for each card; smooth parts
// have as many as their directions need. Such planar projections stretch lengths by 1.7 at most,
// and join_seams() makes values continuous, so this is all the unwrapping that there is
// (experiments 630 and 631).
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

struct Chart {
  std::vector<std::uint32_t> triangles;
  std::vector<V2f> corners;  ///< three for each triangle, in object space units, from (0, 0) on
  V2f size{0, 0};            ///< of the bounding rectangle; x >= y
};

/// Charts of all triangles of `mesh` that have an area.
std::vector<Chart> make_charts(const Mesh& mesh);

/// When a chart is divided.
struct DivisionLimits {
  float length = 0;  ///< longer ones are
  float area = 0;    ///< larger ones are, if their parts have much smaller rectangles: bent strips
};

/// Divides a chart in the middle of its length, and its parts again, as `limits` say.
std::vector<Chart> divide_chart(Chart chart, const DivisionLimits& limits);

}  // namespace dapple
