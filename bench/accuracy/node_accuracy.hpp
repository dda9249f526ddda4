// Part one of the accuracy bench: errors of the opacities that nodes store. In: a scene and its
// BVH. Out: bias and RMS error of the opacity along rays, compared with traced rays, for each size
// of subtree and each ablation of the model.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dapple/bvh.hpp"

namespace dapple::bench {

struct NodeAccuracyOptions {
  int nodes = 60;       ///< maximum for each size
  int directions = 12;  ///< random directions for each node
  int rays = 1024;      ///< for each direction, at least 2
  std::uint64_t seed = 1;
};

/// Error of a model's opacity (model minus truth) over nodes and directions.
struct ModelError {
  double bias = 0;
  double rms = 0;  ///< without the noise of the truth
};

/// Results for subtrees of `triangles` to 2 * triangles - 1 triangles or segments.
struct NodeAccuracyRow {
  std::size_t triangles = 0;
  int nodes = 0;
  double true_opacity = 0;         ///< mean
  std::vector<ModelError> errors;  ///< in the order of model_names()
};

/// The first is the renderer's model. The others omit or replace parts of it.
std::vector<std::string> model_names();

/// `bvh` must be the BVH of `scene`. Needs no device.
std::vector<NodeAccuracyRow> measure_nodes(const Scene& scene, const SceneBvh& bvh,
                                           const NodeAccuracyOptions& options);

}  // namespace dapple::bench
