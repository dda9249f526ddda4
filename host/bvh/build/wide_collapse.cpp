#include "bvh/build/wide_collapse.hpp"

#include <algorithm>
#include <limits>

#include "bvh/build/surface_cost.hpp"

namespace dapple {

CheapestNodes::CheapestNodes(std::span<const BinaryNode> tree, std::uint32_t leaf_size)
    : tree_(tree), leaf_size_(leaf_size), costs_(tree.size()) {
  for (std::size_t n = tree.size(); n-- > 0;) {
    const BinaryNode& node = tree[n];
    if (node.right == 0) {
      costs_[n].cost.fill(leaf_cost(node.area, node.count));
      costs_[n].leaf = true;
    } else {
      costs_[n] = costs_of(node, costs_[n + 1], costs_[node.right]);
    }
  }
}

CheapestNodes::CollapseCosts CheapestNodes::costs_of(const BinaryNode& node,
                                                     const CollapseCosts& left,
                                                     const CollapseCosts& right) const {
  CollapseCosts found;
  found.cost.fill(std::numeric_limits<float>::infinity());
  found.left_children.fill(1);  // also valid if areas are infinite
  const unsigned max_children = std::min<unsigned>(node.count, DAPPLE_BVH_WIDTH);
  for (unsigned children = 2; children <= max_children; ++children) {
    for (unsigned on_left = 1; on_left < children; ++on_left) {
      const float cost = left.cost[on_left - 1] + right.cost[children - on_left - 1];
      if (cost >= found.cost[children - 1]) continue;
      found.cost[children - 1] = cost;
      found.left_children[children - 1] = static_cast<std::uint8_t>(on_left);
    }
  }
  // A subtree may have fewer children than the maximum, but a node has at least two.
  const float divided = found.cost[max_children - 1];
  found.left_children[DAPPLE_BVH_WIDTH - 1] = found.left_children[max_children - 1];
  const float as_leaf = node.count <= leaf_size_ ? leaf_cost(node.area, node.count)
                                                 : std::numeric_limits<float>::infinity();
  found.cost[0] = std::min(as_leaf, divided + node.area);
  found.leaf = node.count <= leaf_size_ && as_leaf <= divided + node.area;
  for (unsigned children = 2; children < DAPPLE_BVH_WIDTH; ++children)
    found.cost[children - 1] = std::min(found.cost[children - 1], found.cost[children - 2]);
  return found;
}

CheapestNodes::Children CheapestNodes::children_of(std::uint32_t node) const {
  Children children;
  if (is_leaf(node))
    add_children(node, 1, children);
  else
    divide(node, DAPPLE_BVH_WIDTH, children);
  return children;
}

void CheapestNodes::add_children(std::uint32_t node, unsigned max_children,
                                 Children& children) const {
  const auto& cost = costs_[node].cost;
  while (max_children > 1 && cost[max_children - 1] == cost[max_children - 2]) --max_children;
  if (max_children > 1)
    divide(node, max_children, children);
  else
    children.node[children.count++] = node;
}

void CheapestNodes::divide(std::uint32_t node, unsigned max_children, Children& children) const {
  const unsigned on_left = costs_[node].left_children[max_children - 1];
  add_children(node + 1, on_left, children);
  add_children(tree_[node].right, max_children - on_left, children);
}

}  // namespace dapple
