#include "bvh/build/binary_tree.hpp"

namespace dapple {
namespace {

void grow(const Splitter& splitter, Part& whole, std::vector<BinaryNode>& tree) {
  const std::size_t at = tree.size();
  tree.push_back({whole.box, whole.area, whole.first, whole.count, 0});
  if (whole.leaf) return;
  Part right;
  splitter.split(whole, right);
  grow(splitter, whole, tree);
  tree[at].right = static_cast<std::uint32_t>(tree.size());
  grow(splitter, right, tree);
}

}  // namespace

std::vector<BinaryNode> build_binary_tree(const Splitter& splitter, const Part& whole) {
  std::vector<BinaryNode> tree;
  tree.reserve(2 * std::size_t{whole.count});
  Part part = whole;
  grow(splitter, part, tree);
  return tree;
}

}  // namespace dapple
