// Greedy collapse: open the child with the largest surface until eight are found (Wald,
// Benthin, Boulos, "Getting Rid of Packets", 2008).
#include "bvh/wide_tree.hpp"

#include <algorithm>

namespace dapple {
namespace {

/// Up to eight nodes of the binary tree that together cover `root`.
std::vector<std::uint32_t> pick_children(const BinaryTree& tree, std::uint32_t root) {
  std::vector<std::uint32_t> picked;
  picked.reserve(DAPPLE_BVH_WIDTH);
  picked.push_back(root);
  while (picked.size() < DAPPLE_BVH_WIDTH) {
    int widest = -1;
    float widest_area = -1.0f;
    for (std::size_t i = 0; i < picked.size(); ++i) {
      const BinaryNode& node = tree.nodes[picked[i]];
      if (node.left && half_area(node.box) > widest_area) {
        widest = static_cast<int>(i);
        widest_area = half_area(node.box);
      }
    }
    if (widest < 0) break;
    const BinaryNode& opened = tree.nodes[picked[widest]];
    picked[widest] = opened.left;
    picked.push_back(opened.right);
  }
  return picked;
}

}  // namespace

WideTree collapse(const BinaryTree& tree) {
  WideTree wide;
  wide.nodes.reserve(tree.order.size() / 4 + 1);
  std::vector<std::uint32_t> source{0};  // binary node of each wide node
  wide.nodes.emplace_back();
  // Depth first, by groups of siblings: what a ray visits together lies together.
  std::vector<std::uint32_t> waiting{0};
  while (!waiting.empty()) {
    const std::uint32_t n = waiting.back();
    waiting.pop_back();
    WideNode node;
    node.box = tree.nodes[source[n]].box;
    node.primitives = tree.nodes[source[n]].count;
    node.first_child = static_cast<std::uint32_t>(wide.children.size());
    for (const std::uint32_t picked : pick_children(tree, source[n])) {
      const BinaryNode& child = tree.nodes[picked];
      WideChild& slot = wide.children.emplace_back();
      ++node.child_count;
      slot.box = child.box;
      if (child.left) {
        slot.first = static_cast<std::uint32_t>(wide.nodes.size());
        wide.nodes.emplace_back();
        source.push_back(picked);
      } else {
        slot.first = child.first;
        slot.count = child.count;
      }
    }
    wide.nodes[n] = node;
    for (unsigned slot = node.child_count; slot-- > 0;) {
      const WideChild& child = wide.children[node.first_child + slot];
      if (child.count == 0) waiting.push_back(child.first);
    }
  }
  wide.nodes.shrink_to_fit();
  wide.children.shrink_to_fit();
  return wide;
}

std::uint32_t stack_needed(const WideTree& tree) {
  // Children come after parents: one backward sweep. A node pops itself and pushes all of
  // its inner children (or instances); the last pushed is traversed on top of the others.
  std::vector<std::uint32_t> needed(tree.nodes.size(), 0);
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    const WideNode& node = tree.nodes[n];
    std::uint32_t deepest = 1;
    for (const WideChild& child : tree.children_of(node)) {
      if (child.count == 0) deepest = std::max(deepest, needed[child.first]);
    }
    needed[n] = node.child_count - 1 + deepest;
  }
  return needed[0];
}

}  // namespace dapple
