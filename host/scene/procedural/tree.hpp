// A broad-leaved tree as one mesh. In: how many leaves, how tall, which seed; out: triangles
// of two materials, the wood first, then two triangles a leaf.
#pragma once

#include <cstdint>

#include "dapple/scene.hpp"
#include "scene/procedural/tree_sway.hpp"

namespace dapple {

struct TreeShape {
  std::uint32_t leaves = 50000;
  std::uint32_t seed = 1;
  float height_m = 8;
  float leaf_length_m = 0;  ///< 0: so that the leaf area index is a real crown's
  bool wood = true;
  Wind wind;  ///< that sways it
};

struct TreeMaterials {
  std::uint32_t leaf = 0;
  std::uint32_t bark = 1;
};

/// Y up, the trunk's foot at the origin. The same bits for the same shape, on any machine and
/// any number of threads; the same vertices and triangles, in number and order, in any wind.
Mesh make_tree(const TreeShape& shape, const TreeMaterials& materials);

}  // namespace dapple
