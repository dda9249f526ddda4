// Divides a mesh into charts: connected triangles that one plane shows without overlaps. In: a
// mesh. Out: flat coordinates of the triangles. Foliage has a chart for each card; smooth parts
// have as many as their directions need. Such planar projections stretch lengths by 1.7 at most,
// and bakes need no continuity across seams, so this is all the unwrapping that there is
//.
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

}  // namespace dapple
