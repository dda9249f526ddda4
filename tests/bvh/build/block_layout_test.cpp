// Where the triangles of nodes lie in blocks of eight: no lane belongs to two nodes, no node needs
// more blocks than alone, and hardly a lane stays empty.
#include "bvh/build/block_layout.hpp"

#include <gtest/gtest.h>

#include <random>

namespace dapple {
namespace {

WideTree tree_of(const std::vector<std::uint32_t>& triangles) {
  WideTree tree;
  for (const std::uint32_t count : triangles) {
    WideNode node;
    node.leaf_primitives = count;
    tree.nodes.push_back(node);
  }
  return tree;
}

std::vector<std::uint32_t> random_counts(std::size_t nodes, std::uint32_t largest) {
  std::mt19937 bits(5);
  std::vector<std::uint32_t> counts(nodes);
  for (std::uint32_t& count : counts)
    count = static_cast<std::uint32_t>(bits() % (largest + 1));
  return counts;
}

/// Checks the layout, and returns the share of lanes that are used.
double check(const std::vector<std::uint32_t>& triangles) {
  const BlockLayout layout = lay_out_blocks(tree_of(triangles));
  EXPECT_EQ(layout.prim_base.size(), triangles.size());
  std::vector<bool> used(8 * std::size_t{layout.blocks});
  std::size_t total = 0;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const std::uint32_t base = layout.prim_base[n], first = bvh_first_lane(base);
    const std::uint32_t end = first + triangles[n];
    EXPECT_LE(end, std::uint32_t{DAPPLE_MAX_PRIMITIVES});
    EXPECT_LE((end + 7) / 8, (triangles[n] + 7) / 8) << "node " << n;
    for (std::uint32_t i = first; i < end; ++i) {
      const std::size_t lane = 8 * std::size_t{bvh_block(base, i)} + i % 8;
      EXPECT_LT(lane, used.size());
      if (lane >= used.size()) return 0;
      EXPECT_FALSE(used[lane]) << "lane " << lane << " of node " << n;
      used[lane] = true;
    }
    total += triangles[n];
  }
  return used.empty() ? 1 : static_cast<double>(total) / static_cast<double>(used.size());
}

TEST(BlockLayout, LanesBelongToOneNodeEach) {
  check(random_counts(20000, 63));
  check(random_counts(20000, 8));
  check({63, 1, 63, 7, 8, 1, 16, 62, 1, 1});
}

TEST(BlockLayout, NodesOfFewTrianglesFillNearlyAllLanes) {
  EXPECT_GT(check(random_counts(20000, 16)), 0.93);
}

TEST(BlockLayout, ANodeStartsInTheBlockThatTheLastLeftOpen) {
  const BlockLayout layout = lay_out_blocks(tree_of({12, 12, 0, 4, 4}));
  EXPECT_EQ(layout.blocks, 4u);
  EXPECT_EQ(bvh_block_index(layout.prim_base[1]), 1u);
  EXPECT_EQ(bvh_first_lane(layout.prim_base[1]), 4u);
  EXPECT_EQ(layout.prim_base[2], 0u);
  EXPECT_EQ(layout.prim_base[3], 3u);
  EXPECT_EQ(layout.prim_base[4], 3u | 4u << DAPPLE_FIRST_LANE_SHIFT);
}

}  // namespace
}  // namespace dapple
