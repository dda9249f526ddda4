// Part four of the accuracy bench: time and memory of prefiltering. In: clouds of growing size.
// Out: seconds and bytes for each size.
#pragma once

#include <string>
#include <vector>

namespace dapple::bench {

struct PrefilterCostRow {
  std::size_t triangles = 0;
  double build_seconds = 0, prefilter_seconds = 0;  ///< wall time, minimum of the repetitions
  double ratio = 0;  ///< growth of prefilter_seconds for ten times the triangles; first row: 0
  double scene_bytes = 0;           ///< meshes, which stay in memory
  double bvh_bytes = 0;             ///< the finished BVH: nodes, blocks, textured triangles
  double build_peak_bytes = 0;      ///< peak of resident memory while building, without the scene
  double prefilter_peak_bytes = 0;  ///< the same while prefiltering
};

/// Clouds of 0.2, 2 and 8 million triangles, three times each; `quick`: 0.02, 0.2 and 0.8.
std::vector<PrefilterCostRow> measure_prefilter_cost(bool quick);

std::string cost_text(const std::vector<PrefilterCostRow>& rows);

}  // namespace dapple::bench
