// Collapse of a binary tree into eight-wide nodes: its cost must equal the minimum that an
// exhaustive search over all possible nodes finds.
#include "bvh/build/wide_collapse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "bvh/build/surface_cost.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kLeafSize = 4;

/// Appends a random binary tree over `count` primitives. Areas shrink towards the leaves. Subtrees
/// of two primitives are split or not, at random.
void grow(std::uint32_t first, std::uint32_t count, float area, std::mt19937& random,
          std::vector<BinaryNode>& tree) {
  const std::size_t at = tree.size();
  BinaryNode node{};
  node.box.clear();
  node.area = area;
  node.first = first;
  node.count = count;
  node.right = 0;
  tree.push_back(node);
  if (count == 1 || (count == 2 && random() % 2)) return;
  std::uniform_real_distribution<float> part(0.3f, 0.8f);
  const auto left = static_cast<std::uint32_t>(1 + random() % (count - 1));
  grow(first, left, area * part(random), random, tree);
  tree[at].right = static_cast<std::uint32_t>(tree.size());
  grow(first + left, count - left, area * part(random), random, tree);
}

/// Finds the minimum cost by an exhaustive search.
class Exhaustive {
 public:
  explicit Exhaustive(const std::vector<BinaryNode>& tree) : tree_(tree), as_child_(tree.size()) {
    for (std::size_t n = tree.size(); n-- > 0;) as_child_[n] = as_child(static_cast<unsigned>(n));
  }

  /// Minimum cost of the whole tree.
  float cost() const { return as_child_[0]; }

 private:
  float as_child(std::uint32_t node) const {
    const BinaryNode& it = tree_[node];
    const float leaf = it.count <= kLeafSize || it.right == 0
                           ? leaf_cost(it.area, it.count)
                           : std::numeric_limits<float>::infinity();
    return it.right == 0 ? leaf : std::min(leaf, it.area + below({node + 1, it.right}, 0));
  }

  /// Minimum cost of a node's children. Those before `from` stay as they are; each other child may
  /// be replaced by its own children.
  float below(const std::vector<std::uint32_t>& children, std::size_t from) const {
    if (from == children.size()) {
      float sum = 0;
      for (const std::uint32_t child : children) sum += as_child_[child];
      return sum;
    }
    float min = below(children, from + 1);
    const std::uint32_t opened = children[from];
    if (tree_[opened].right != 0 && children.size() < DAPPLE_BVH_WIDTH) {
      std::vector<std::uint32_t> more = children;
      more[from] = opened + 1;
      more.push_back(tree_[opened].right);
      min = std::min(min, below(more, from));
    }
    return min;
  }

  const std::vector<BinaryNode>& tree_;
  std::vector<float> as_child_;
};

float cost_of(const std::vector<BinaryNode>& tree, const CheapestNodes& nodes, std::uint32_t node) {
  const BinaryNode& it = tree[node];
  if (nodes.is_leaf(node)) return leaf_cost(it.area, it.count);
  const CheapestNodes::Children children = nodes.children_of(node);
  EXPECT_GE(children.count, 2u);
  float sum = it.area;
  std::uint32_t next = it.first;
  for (unsigned i = 0; i < children.count; ++i) {
    EXPECT_EQ(tree[children.node[i]].first, next) << "a gap between children";
    next += tree[children.node[i]].count;
    sum += cost_of(tree, nodes, children.node[i]);
  }
  EXPECT_EQ(next, it.first + it.count) << "not all primitives";
  return sum;
}

TEST(WideCollapse, NoOtherNodesAreCheaper) {
  std::mt19937 random(11);
  bool several_levels = false;
  for (int i = 0; i < 300; ++i) {
    std::vector<BinaryNode> tree;
    grow(0, static_cast<std::uint32_t>(2 + random() % 23), 1.0f, random, tree);
    const CheapestNodes nodes(tree, kLeafSize);
    const float found = cost_of(tree, nodes, 0), min = Exhaustive(tree).cost();
    EXPECT_NEAR(found, min, 1e-5f * min) << "tree " << i;
    if (nodes.is_leaf(0)) continue;
    const CheapestNodes::Children children = nodes.children_of(0);
    for (unsigned c = 0; c < children.count; ++c)
      several_levels |= !nodes.is_leaf(children.node[c]);
  }
  EXPECT_TRUE(several_levels) << "trees too small to tell";
}

TEST(WideCollapse, InfiniteAreasMakeNoLargeLeaves) {
  std::mt19937 random(2);
  std::vector<BinaryNode> tree;
  grow(0, 1000, std::numeric_limits<float>::infinity(), random, tree);
  const CheapestNodes nodes(tree, kLeafSize);
  std::vector<std::uint32_t> pending{0};
  std::uint32_t in_leaves = 0;
  while (!pending.empty()) {
    const std::uint32_t node = pending.back();
    pending.pop_back();
    if (nodes.is_leaf(node)) {
      ASSERT_LE(tree[node].count, kLeafSize);
      in_leaves += tree[node].count;
      continue;
    }
    const CheapestNodes::Children children = nodes.children_of(node);
    ASSERT_GE(children.count, 2u);
    pending.insert(pending.end(), children.node.begin(), children.node.begin() + children.count);
  }
  EXPECT_EQ(in_leaves, 1000u);
}

TEST(WideCollapse, ALeafIsItsOwnOnlyChild) {
  std::mt19937 random(1);
  std::vector<BinaryNode> tree;
  grow(0, 1, 1.0f, random, tree);
  const CheapestNodes nodes(tree, kLeafSize);
  EXPECT_TRUE(nodes.is_leaf(0));
  const CheapestNodes::Children children = nodes.children_of(0);
  ASSERT_EQ(children.count, 1u);
  EXPECT_EQ(children.node[0], 0u);
}

}  // namespace
}  // namespace dapple
