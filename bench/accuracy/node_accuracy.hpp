// Part one of the accuracy bench: the opacity a node stores, turned into one along a ray,
// against ray-sampled truth, by size of the subtree, with ablations.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dapple/bvh.hpp"

namespace dapple::bench {

struct NodeAccuracyOptions {
  int nodes = 60;       ///< of each size, at most
  int directions = 12;  ///< random ones a node
  int rays = 1024;      ///< a direction, at least 2
  std::uint64_t seed = 1;
};

/// Opacity of a model minus the truth, over nodes and directions.
struct ModelError {
  double bias = 0;
  double rms = 0;  ///< the truth's own noise taken out
};

/// Subtrees of [triangles, 2 triangles).
struct NodeAccuracyRow {
  std::size_t triangles = 0;
  int nodes = 0;
  double true_opacity = 0;         ///< mean
  std::vector<ModelError> errors;  ///< in the order of model_names()
};

/// The renderer's own model first, then what is left of it when one part is taken out or
/// replaced.
std::vector<std::string> model_names();

/// `scene` is what `bvh` was built from. Needs no device.
std::vector<NodeAccuracyRow> measure_nodes(const Scene& scene, const SceneBvh& bvh,
                                           const NodeAccuracyOptions& options);

}  // namespace dapple::bench
