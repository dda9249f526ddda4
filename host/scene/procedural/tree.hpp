// Makes a broad-leaved tree as one mesh. In: number of leaves, height, seed, wind; out: triangles
// of two materials, first those of the wood, then two for each leaf.
#pragma once

#include <cstdint>

#include "dapple/scene.hpp"
#include "scene/procedural/tree_sway.hpp"

namespace dapple {

struct TreeShape {
  std::uint32_t leaves = 50000;
  std::uint32_t seed = 1;
  float height_m = 8;
  float leaf_length_m = 0;  ///< 0: chosen for the leaf area index of a real crown
  bool wood = true;
  Wind wind;
};

struct TreeMaterials {
  std::uint32_t leaf = 0;
  std::uint32_t bark = 1;
};

/// +Y is up, the trunk's foot is at the origin. The same shape gives the same bits on any machine
/// and with any number of threads. The wind does not change the number and order of vertices and
/// triangles.
Mesh make_tree(const TreeShape& shape, const TreeMaterials& materials);

}  // namespace dapple
