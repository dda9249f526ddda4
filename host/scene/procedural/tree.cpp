// Makes the leaves on a tree's twigs, and puts them and the wood into one mesh: see tree.hpp.
#include "scene/procedural/tree.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/pcg32.hpp"
#include "scene/procedural/tree_skeleton.hpp"
#include "scene/procedural/tree_wood.hpp"

namespace dapple {
namespace {

// One-sided leaf area divided by the ground area under the crown; broad-leaved trees have 3 to 6.
constexpr float kLeafAreaIndex = 4.0f;

float leaf_length(const TreeShape& shape) {
  if (shape.leaf_length_m > 0) return shape.leaf_length_m;
  const float crown_radius = kCrownRadius * shape.height_m;
  const float area = kLeafAreaIndex * std::numbers::pi_v<float> * crown_radius * crown_radius;
  const float length = std::sqrt(area / (kBladeArea * static_cast<float>(shape.leaves)));
  return std::min(length, 0.03f * shape.height_m);  // limits the size when there are few leaves
}

// Makes a leaf near its twig that points away from it and hangs down a little. Its upper side
// faces roughly up, with a random deviation. `reach` is the largest distance from the twig, metres.
Blade grow_leaf(Pcg32& rng, V3f twig, V3f twig_foot, float reach, float length) {
  const V3f along = twig_foot + (twig - twig_foot) * rng.unit();
  const V3f offset = point_in_ball(rng);
  const V3f wander = unit_vector(rng);
  const V3f lean = unit_vector(rng);
  Blade blade;
  blade.base = along + offset * V3f(reach, 0.7f * reach, reach);
  blade.axis = (offset * 0.6f + wander * 0.8f + V3f(0, -0.3f, 0)).normalized();
  V3f up = V3f(0, 1, 0) + lean * 0.9f;
  up -= blade.axis * up.dot(blade.axis);
  blade.normal = up.length2() > 1e-6f ? up.normalized() : perpendicular(blade.axis);
  // When the sum for the axis is zero, the axis is any direction perpendicular to the normal.
  if (blade.axis.length2() < 0.5f) blade.axis = perpendicular(blade.normal);
  blade.length = length * rng.between(0.75f, 1.25f);
  return blade;
}

Blade carry_leaf(Blade leaf, const SwayingSkeleton& swaying, std::uint32_t twig) {
  leaf.base = swaying.moved(twig, leaf.base);
  leaf.axis = swaying.turned(twig, leaf.axis);
  leaf.normal = swaying.turned(twig, leaf.normal);
  return leaf;
}

void append_leaves(Mesh& mesh, const TreeSkeleton& tree, const SwayingSkeleton* swaying,
                   const TreeShape& shape, std::uint32_t material) {
  BladeRange blades(mesh, shape.leaves, material);
  const float length = leaf_length(shape);
  const float reach = 0.034f * shape.height_m;
  const auto grow = [&](const tbb::blocked_range<std::uint32_t>& range) {
    for (std::uint32_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      // Leaves of one twig are adjacent in memory.
      const std::uint64_t twig_count = tree.twigs.size();
      const std::uint32_t twig = tree.twigs[leaf * twig_count / shape.leaves];
      Pcg32 rng(shape.seed, leaf);
      Blade blade =
          grow_leaf(rng, tree.positions[twig], tree.positions[tree.parents[twig]], reach, length);
      if (swaying != nullptr)
        blade = flutter(carry_leaf(blade, *swaying, twig), shape.wind, shape.seed, leaf);
      blades.set(leaf, blade);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, shape.leaves, 4096), grow);
}

}  // namespace

Mesh make_tree(const TreeShape& shape, const TreeMaterials& materials) {
  const TreeSkeleton skeleton = grow_skeleton(shape.seed, shape.height_m);
  std::optional<SwayingSkeleton> swaying;
  if (shape.wind.blows()) swaying.emplace(skeleton, shape.height_m, shape.wind);
  const SwayingSkeleton* const sway = swaying ? &*swaying : nullptr;
  Mesh mesh;
  mesh.name = "tree";
  if (shape.wood) append_wood(mesh, skeleton, sway, materials.bark);
  append_leaves(mesh, skeleton, sway, shape, materials.leaf);
  return mesh;
}

}  // namespace dapple
