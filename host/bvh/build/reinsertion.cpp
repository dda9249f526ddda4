#include "bvh/build/reinsertion.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "bvh/build/multiversion.hpp"

namespace dapple {
namespace {

/// Maximum number of levels of a reinserted tree; deeper trees are discarded. (The splitter makes
/// about 48 levels, counted from the root of the object.) The cheapest tree over nested boxes is a
/// chain, which would exceed every stack.
constexpr unsigned kDeepest = 64;

/// Maximum number of nodes that the searches of a round may look at below the siblings of
/// ancestors, divided by the number of nodes. Where boxes overlap, a subtree fits nearly
/// everywhere, and a search visits many nodes. In plants a search visits fewer than fifty.
constexpr std::size_t kEvaluationsPerNode = 64;

/// A binary node with a link to its parent, in one cache line. Node 0 is the root; as a child, 0
/// means none.
struct alignas(64) LinkedNode {
  Box8 box;
  float area;
  std::uint32_t parent;
  std::uint32_t child[2];  ///< 0: a leaf

  [[nodiscard]] std::uint32_t other_than(std::uint32_t node) const {
    return child[child[0] == node];
  }
};

/// A new sibling for a subtree, and the decrease of the sum of areas.
struct Insertion {
  std::uint32_t node = 0;
  float gain = 0;
};

/// An inner node whose children are to be visited, and the gain so far, without the cost of
/// inserting the subtree there.
struct Candidate {
  std::uint32_t node;
  float gain;
};

/// The remaining effort of the searches, and their working memory.
struct Effort {
  std::size_t evaluations = 0;
  std::vector<Candidate> pending;
};

/// The search for the best new sibling of one subtree.
struct Search {
  const LinkedNode* nodes;
  const LinkedNode& moved;
  Insertion best;

  /// True if no node to which the subtree could be added with this gain is better than the best.
  [[nodiscard]] bool is_pruned(float gain) const { return gain - moved.area <= best.gain; }

  /// Takes `node` as the best if it is, and returns the gain with which its children can be
  /// visited.
  [[gnu::always_inline]] float evaluate(std::uint32_t node, float gain) {
    Box8 both = nodes[node].box;
    both.add(moved.box);
    const float area = both.half_area();
    if (gain - area > best.gain) best = {node, gain - area};
    return gain - (area - nodes[node].area);
  }

  /// True if the nodes below `node` need a visit.
  [[nodiscard]] bool goes_below(std::uint32_t node, float gain) const {
    return nodes[node].child[0] != 0 && !is_pruned(gain);
  }

  /// Looks at `top` and the nodes below it, within the remaining effort: at both children of a node
  /// together, then below the one with the larger gain.
  [[gnu::always_inline]] void search_below(std::uint32_t top, float gain, Effort& effort) {
    if (is_pruned(gain)) return;
    const float below = evaluate(top, gain);
    if (!goes_below(top, below)) return;
    std::vector<Candidate>& pending = effort.pending;
    pending.assign(1, {top, below});
    while (!pending.empty() && effort.evaluations > 1) {
      const Candidate at = pending.back();
      pending.pop_back();
      if (is_pruned(at.gain)) continue;
      effort.evaluations -= 2;
      Candidate first{nodes[at.node].child[0], 0}, second{nodes[at.node].child[1], 0};
      first.gain = evaluate(first.node, at.gain);
      second.gain = evaluate(second.node, at.gain);
      if (first.gain < second.gain) std::swap(first, second);
      if (goes_below(second.node, second.gain)) pending.push_back(second);
      if (goes_below(first.node, first.gain)) pending.push_back(first);
    }
  }
};

/// Returns the best new sibling of node `moved`; node 0 if it should stay where it is. Its parent
/// must not be the root.
DAPPLE_MULTIVERSION
Insertion find_insertion(const LinkedNode* nodes, std::uint32_t moved, Effort& effort) {
  Search search{nodes, nodes[moved], {}};
  std::uint32_t below = nodes[moved].parent;
  float gain = nodes[below].area;
  std::uint32_t sibling = nodes[below].other_than(moved);
  Box8 rest = nodes[sibling].box;  // box of the current ancestor without the moved subtree
  search.search_below(sibling, gain, effort);
  while (below != 0) {
    const std::uint32_t ancestor = nodes[below].parent;
    sibling = nodes[ancestor].other_than(below);
    search.search_below(sibling, gain, effort);
    rest.add(nodes[sibling].box);
    gain += nodes[ancestor].area - rest.half_area();
    below = ancestor;
  }
  return search.best;
}

/// Recomputes the boxes of a node and of all its ancestors. Returns how many these are.
DAPPLE_MULTIVERSION
unsigned fit_upwards(LinkedNode* nodes, std::uint32_t node) {
  for (unsigned levels = 1;; node = nodes[node].parent, ++levels) {
    LinkedNode& it = nodes[node];
    it.box = nodes[it.child[0]].box;
    it.box.add(nodes[it.child[1]].box);
    it.area = it.box.half_area();
    if (node == 0) return levels;
  }
}

class Reinsertion {
 public:
  explicit Reinsertion(const std::vector<BinaryNode>& tree) : nodes_(tree.size()) {
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      nodes_[n].box = tree[n].box;
      nodes_[n].area = tree[n].area;
      nodes_[n].child[0] = nodes_[n].child[1] = 0;
      if (tree[n].right != 0) set_children(n, n + 1, tree[n].right);
    }
  }

  void round() {
    effort_.evaluations = kEvaluationsPerNode * nodes_.size();
    for (const std::uint32_t node : by_area()) {
      if (too_deep_ || effort_.evaluations <= 1) return;
      if (nodes_[node].parent == 0) continue;
      const Insertion insertion = find_insertion(nodes_.data(), node, effort_);
      if (insertion.node != 0) move(node, insertion.node);
    }
  }

  [[nodiscard]] bool is_too_deep() const {
    std::vector<std::pair<std::uint32_t, unsigned>> pending{{0, 1}};  // with their levels
    while (!pending.empty()) {
      const auto [node, level] = pending.back();
      pending.pop_back();
      if (level > kDeepest) return true;
      if (nodes_[node].child[0] == 0) continue;
      for (const std::uint32_t child : nodes_[node].child) pending.push_back({child, level + 1});
    }
    return too_deep_;
  }

  /// Appends node `from` and all nodes below to `to`, and the boxes of their leaves to `order`.
  /// `leaves`: the tree before, with the ranges of the leaves in `boxes`; `first`: index of the
  /// first box.
  void write(std::uint32_t from, const std::vector<BinaryNode>& leaves,
             std::span<const PrimitiveBox> boxes, std::uint32_t first,
             std::vector<PrimitiveBox>& order, std::vector<BinaryNode>& to) const {
    const LinkedNode& node = nodes_[from];
    const std::size_t at = to.size(), before = order.size();
    to.push_back({node.box, node.area, first + static_cast<std::uint32_t>(before), 0, 0});
    if (node.child[0] == 0) {
      const auto range = boxes.subspan(leaves[from].first, leaves[from].count);
      order.insert(order.end(), range.begin(), range.end());
    } else {
      write(node.child[0], leaves, boxes, first, order, to);
      to[at].right = static_cast<std::uint32_t>(to.size());
      write(node.child[1], leaves, boxes, first, order, to);
    }
    to[at].count = static_cast<std::uint32_t>(order.size() - before);
  }

 private:
  /// Returns all nodes but the root, those of the largest areas first.
  [[nodiscard]] std::vector<std::uint32_t> by_area() const {
    std::vector<std::uint64_t> keys(nodes_.size() - 1);  // the bits of positive floats are ordered
    for (std::uint32_t n = 1; n < nodes_.size(); ++n)
      keys[n - 1] = std::uint64_t{~std::bit_cast<std::uint32_t>(nodes_[n].area)} << 32 | n;
    tbb::parallel_sort(keys.begin(), keys.end());
    return {keys.begin(), keys.end()};
  }

  void set_children(std::uint32_t node, std::uint32_t left, std::uint32_t right) {
    nodes_[node].child[0] = left;
    nodes_[node].child[1] = right;
    nodes_[left].parent = nodes_[right].parent = node;
  }

  void replace(std::uint32_t child, std::uint32_t by) {
    const std::uint32_t parent = nodes_[child].parent;
    nodes_[parent].child[nodes_[parent].child[1] == child] = by;
    nodes_[by].parent = parent;
  }

  void move(std::uint32_t node, std::uint32_t beside) {
    const std::uint32_t parent = nodes_[node].parent;
    replace(parent, nodes_[parent].other_than(node));
    fit(nodes_[parent].parent);
    replace(beside, parent);
    set_children(parent, beside, node);
    fit(parent);
  }

  void fit(std::uint32_t node) { too_deep_ |= fit_upwards(nodes_.data(), node) > kDeepest; }

  std::vector<LinkedNode> nodes_;
  Effort effort_;
  bool too_deep_ = false;
};

}  // namespace

void reinsert_subtrees(int rounds, std::span<PrimitiveBox> boxes, std::vector<BinaryNode>& tree) {
  if (tree.size() < 5) return;               // no node has a grandparent
  if (!std::isfinite(tree[0].area)) return;  // areas cannot be compared
  Reinsertion reinsertion(tree);
  for (int round = 0; round < rounds; ++round) reinsertion.round();
  if (reinsertion.is_too_deep()) return;
  std::vector<PrimitiveBox> order;
  order.reserve(tree[0].count);
  std::vector<BinaryNode> better;
  better.reserve(tree.size());
  reinsertion.write(0, tree, boxes, tree[0].first, order, better);
  std::copy(order.begin(), order.end(), boxes.begin() + tree[0].first);
  tree = std::move(better);
}

}  // namespace dapple
