// A large node splits its child of the largest area until there are eight (Wald, Benthin, Boulos,
// "Getting Rid of Packets", 2008). Smaller subtrees are built in parallel: first as binary trees,
// then converted to nodes of eight of minimal cost. Each subtree has its own arrays, which are
// joined at the end.
#include "bvh/build/wide_tree.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <memory>

#include "bvh/build/binary_tree.hpp"
#include "bvh/build/reinsertion.hpp"
#include "bvh/build/splitter.hpp"
#include "bvh/build/wide_collapse.hpp"

namespace dapple {
namespace {

/// Subtrees of up to this many primitives are built by one thread.
constexpr std::uint32_t kTaskPrimitives = 1u << 15;

/// Maximum number of primitives of an object whose subtrees are reinserted, and the number of
/// rounds of reinsertion: experiment 103. Larger objects gain nothing: experiment 104.
constexpr std::size_t kMaxReinserted = 1u << 18;
constexpr int kRounds = 2;

/// A range divided into up to eight parts, of which the largest was split each time.
struct Parts {
  std::array<Part, DAPPLE_BVH_WIDTH> part;
  unsigned count = 1;

  Parts(const Part& whole, const Splitter& splitter) {
    part[0] = whole;
    while (count < DAPPLE_BVH_WIDTH) {
      Part* widest = nullptr;
      for (unsigned i = 0; i < count; ++i) {
        if (!part[i].leaf && (!widest || part[i].area > widest->area)) widest = &part[i];
      }
      if (!widest) break;
      splitter.split(*widest, part[count++]);
    }
  }
};

/// Appends the children of a node and returns the node. Inner children have count 0; their nodes
/// are those from `next_node` on.
WideNode add_children(const Box8& box, std::uint32_t primitives,
                      std::span<const WideChild> children, std::uint32_t next_node,
                      WideTree& tree) {
  WideNode node{box.box(), static_cast<std::uint32_t>(tree.children.size()),
                static_cast<std::uint32_t>(children.size()), primitives, 0};
  for (WideChild child : children) {
    node.leaf_primitives += child.count;
    if (child.count == 0) child.first = next_node++;
    tree.children.push_back(child);
  }
  return node;
}

/// Converts a binary tree to nodes of eight, depth first by groups of siblings: nodes that a ray
/// visits together are adjacent.
class Growth {
 public:
  Growth(std::span<const BinaryNode> binary, std::uint32_t leaf_size, WideTree& tree)
      : binary_(binary), cheapest_(binary, leaf_size), tree_(tree) {}

  /// Makes node `index` of the wide tree from binary node `from`, and all nodes below.
  void grow(std::uint32_t from, std::size_t index) {
    const CheapestNodes::Children children = cheapest_.children_of(from);
    std::array<WideChild, DAPPLE_BVH_WIDTH> wide;
    for (unsigned i = 0; i < children.count; ++i) {
      const BinaryNode& child = binary_[children.node[i]];
      wide[i] = {child.box.box(), child.first,
                 cheapest_.is_leaf(children.node[i]) ? child.count : 0};
    }
    std::size_t next = tree_.nodes.size();
    tree_.nodes[index] =
        add_children(binary_[from].box, binary_[from].count, {wide.data(), children.count},
                     static_cast<std::uint32_t>(next), tree_);
    for (unsigned i = 0; i < children.count; ++i) {
      if (wide[i].count == 0) tree_.nodes.emplace_back();
    }
    for (unsigned i = 0; i < children.count; ++i) {
      if (wide[i].count == 0) grow(children.node[i], next++);
    }
  }

 private:
  std::span<const BinaryNode> binary_;
  CheapestNodes cheapest_;
  WideTree& tree_;
};

std::vector<BinaryNode> binary_subtree(const Splitter& splitter, const Part& whole) {
  std::vector<BinaryNode> binary = build_binary_tree(splitter, whole);
  if (splitter.result().size() <= kMaxReinserted)
    reinsert_subtrees(kRounds, splitter.result(), binary);
  return binary;
}

/// A subtree with its own arrays. A large subtree holds only its root; its children are branches.
struct Branch {
  WideTree tree;
  std::vector<Branch> below;
  std::size_t node_count = 0, child_count = 0;  ///< including all nodes below
};

Branch grow_branch(const Splitter& splitter, Part& whole, std::uint32_t leaf_size) {
  Branch branch;
  branch.tree.nodes.emplace_back();
  if (whole.count <= kTaskPrimitives) {
    splitter.move_to_result(whole);
    const std::vector<BinaryNode> binary = binary_subtree(splitter, whole);
    branch.tree.nodes.reserve(whole.count / 8 + 1);
    branch.tree.children.reserve(whole.count + 1);
    Growth(binary, leaf_size, branch.tree).grow(0, 0);
    branch.node_count = branch.tree.nodes.size();
    branch.child_count = branch.tree.children.size();
    return branch;
  }
  Parts parts(whole, splitter);
  std::array<WideChild, DAPPLE_BVH_WIDTH> children;
  std::vector<Part*> inner;
  for (unsigned i = 0; i < parts.count; ++i) {
    Part& part = parts.part[i];
    children[i] = {part.box.box(), part.first, part.leaf ? part.count : 0};
    if (part.leaf) splitter.move_to_result(part);
    if (!part.leaf) inner.push_back(&part);
  }
  branch.tree.nodes[0] =
      add_children(whole.box, whole.count, {children.data(), parts.count}, 0, branch.tree);
  branch.below.resize(inner.size());
  tbb::parallel_for(std::size_t{0}, inner.size(), [&](std::size_t i) {
    branch.below[i] = grow_branch(splitter, *inner[i], leaf_size);
  });
  branch.node_count = 1;
  branch.child_count = branch.tree.children.size();
  for (const Branch& child : branch.below) {
    branch.node_count += child.node_count;
    branch.child_count += child.child_count;
  }
  return branch;
}

/// Copies a branch into the final arrays: its root to node `root`, other nodes from `nodes` on,
/// children from `children` on. Frees the branch.
void place(Branch& branch, std::size_t root, std::size_t nodes, std::size_t children,
           WideTree& tree) {
  const std::size_t own = branch.tree.nodes.size();
  for (std::size_t n = 0; n < own; ++n) {
    WideNode& node = tree.nodes[n ? nodes + n - 1 : root] = branch.tree.nodes[n];
    node.first_child += static_cast<std::uint32_t>(children);
  }
  // Indices in a subtree count from its root. Indices in a branch with branches below count from
  // its first inner child.
  const std::size_t inner_base = branch.below.empty() ? nodes - 1 : nodes;
  WideChild* to = &tree.children[children];
  for (WideChild child : branch.tree.children) {
    if (child.count == 0) child.first += static_cast<std::uint32_t>(inner_base);
    *to++ = child;
  }
  const std::size_t below_count = branch.below.size();
  std::vector<std::size_t> node_at(below_count), child_at(below_count);
  std::size_t next_node = nodes + below_count, next_child = children + branch.tree.children.size();
  branch.tree = {};
  for (std::size_t i = 0; i < below_count; ++i) {
    node_at[i] = next_node;
    child_at[i] = next_child;
    next_node += branch.below[i].node_count - 1;
    next_child += branch.below[i].child_count;
  }
  tbb::parallel_for(std::size_t{0}, below_count, [&](std::size_t i) {
    place(branch.below[i], nodes + i, node_at[i], child_at[i], tree);
  });
}

Branch grow_all(std::span<PrimitiveBox> boxes, std::uint32_t leaf_size) {
  const auto second = std::make_unique_for_overwrite<PrimitiveBox[]>(boxes.size());
  const Splitter splitter(boxes, {second.get(), boxes.size()}, leaf_size);
  Part whole = splitter.all();
  return grow_branch(splitter, whole, leaf_size);
}

}  // namespace

WideTree build_wide_tree(std::span<PrimitiveBox> boxes, std::uint32_t leaf_size) {
  Branch branch = grow_all(boxes, leaf_size);
  if (branch.below.empty()) return std::move(branch.tree);
  WideTree tree;
  tbb::parallel_invoke([&] { tree.nodes.resize(branch.node_count); },
                       [&] { tree.children.resize(branch.child_count); });
  place(branch, 0, 1, 0, tree);
  return tree;
}

std::uint32_t stack_needed(const WideTree& tree) {
  // Children come after their parents, so one backward loop is enough. A traversal pops a node and
  // pushes all of its inner children (or instances). The last one pushed is traversed while the
  // others are on the stack.
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
