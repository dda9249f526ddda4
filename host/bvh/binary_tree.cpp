// Binned SAH (Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007).
// A node's place in the array follows from its range alone, so that subtrees can be built
// in parallel without a shared counter and come out the same.
#include "bvh/binary_tree.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

#include "bvh/float4.hpp"

namespace dapple {
namespace {

constexpr int kBins = 16;

/// Few primitives don't need many bins, whose setting up would cost more than they.
int bins_for(std::uint32_t count) { return count >= 32 ? kBins : count >= 6 ? 8 : 4; }

constexpr std::uint32_t kParallelBinning = 1u << 16;
constexpr std::uint32_t kParallelSubtree = 1u << 12;
/// Below this depth ranges are halved, which bounds the depth of hostile input.
constexpr int kDeepest = 48;
/// Cost of a triangle test over that of a box test; leaves of 8 lanes are cheap.
constexpr float kPrimitiveCost = 0.6f;

struct Loaded {
  Float4 lower, upper;
  /// Twice the centre; the fourth lanes hold integers and are cleared.
  [[nodiscard]] Float4 centre2() const {
    const Float4 sum = lower + upper;
    return Float4{sum[0], sum[1], sum[2], 0.0f};
  }
};

Loaded load(const PrimitiveBox& prim) {
  static_assert(sizeof(PrimitiveBox) == 2 * sizeof(Float4));
  Loaded loaded;
  std::memcpy(&loaded, &prim, sizeof loaded);
  loaded.lower[3] = 0.0f;
  loaded.upper[3] = 0.0f;
  return loaded;
}

struct Extent {
  Box4 box = empty_box4(), centres2 = empty_box4();
  void add(const Loaded& prim) {
    box.add(prim.lower, prim.upper);
    const Float4 centre2 = prim.centre2();
    centres2.add(centre2, centre2);
  }
  void add(const Extent& other) {
    box.add(other.box);
    centres2.add(other.centres2);
  }
};

struct Bins {
  std::array<std::array<Box4, 3>, kBins> box;  // by bin, then axis: few bins are few cache lines
  std::array<std::array<std::uint32_t, 3>, kBins> count;
  explicit Bins(int used) {
    std::fill_n(box.begin(), used, std::array<Box4, 3>{empty_box4(), empty_box4(), empty_box4()});
    std::fill_n(count.begin(), used, std::array<std::uint32_t, 3>{});
  }
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < kBins; ++b) {
        box[b][a].add(other.box[b][a]);
        count[b][a] += other.count[b][a];
      }
    }
  }
};

/// Maps centres to bins; an axis along which all centres agree has scale 0.
struct Binning {
  Float4 start, scale = splat4(0.0f);
  int bins_used;
  Binning(const Box4& centres2, std::uint32_t count)
      : start(centres2.lower), bins_used(bins_for(count)) {
    const Float4 size = centres2.upper - centres2.lower;
    for (int a = 0; a < 3; ++a) {
      const float bins = static_cast<float>(bins_used);
      if (size[a] > 0.0f && bins / size[a] < 1e30f) scale[a] = bins * 0.99999f / size[a];
    }
  }
  [[nodiscard]] Int4 bins(const Loaded& prim) const {
    const Float4 at = (prim.centre2() - start) * scale;
    return __builtin_convertvector(
        min4(max4(at, splat4(0.0f)), splat4(static_cast<float>(bins_used - 1))), Int4);
  }
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;
  int last_left = 0;  ///< bins up to this one go left
};

class Builder {
 public:
  Builder(BinaryTree& tree, std::uint32_t leaf_size)
      : nodes_(tree.nodes), order_(tree.order), leaf_size_(leaf_size) {}

  void build() {
    const auto count = static_cast<std::uint32_t>(order_.size());
    build(0, {0, count}, measure({0, count}), 0);
  }

 private:
  struct Range {
    std::uint32_t first, count;
  };

  void build(std::uint32_t index, Range range, const Extent& extent, int depth) {
    BinaryNode& node = nodes_[index];
    node = {extent.box.box(), range.first, range.count, 0, 0};
    if (range.count == 1) return;
    if (range.count == 2 && leaf_size_ >= 2) return build_pair(index, range.first, extent);
    const Binning binning(extent.centres2, range.count);
    const Split split =
        depth < kDeepest ? best_split(fill(binning, range), binning.bins_used) : Split{};
    if (range.count <= leaf_size_ && leaf_is_cheaper(extent, range.count, split.cost)) return;
    Extent part[2];
    const std::uint32_t left_count = partition(binning, split, range, part);
    node.left = index + 1;
    node.right = index + 2 * left_count;
    const auto left = [&] { build(node.left, {range.first, left_count}, part[0], depth + 1); };
    const auto right = [&] {
      build(node.right, {range.first + left_count, range.count - left_count}, part[1], depth + 1);
    };
    if (range.count > kParallelSubtree) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

  /// Two primitives: a third of all nodes, and there is only one way to split them.
  void build_pair(std::uint32_t index, std::uint32_t first, const Extent& extent) {
    const Loaded a = load(order_[first]), b = load(order_[first + 1]);
    const Box4 box_a{a.lower, a.upper}, box_b{b.lower, b.upper};
    if (leaf_is_cheaper(extent, 2, box_a.half_area() + box_b.half_area())) return;
    nodes_[index].left = index + 1;
    nodes_[index].right = index + 2;
    nodes_[index + 1] = {box_a.box(), first, 1, 0, 0};
    nodes_[index + 2] = {box_b.box(), first + 1, 1, 0, 0};
  }

  /// `split_cost`: areas of the parts times their primitives, summed; infinite without a split.
  static bool leaf_is_cheaper(const Extent& extent, std::uint32_t count, float split_cost) {
    const float area = extent.box.half_area();
    return area + kPrimitiveCost * split_cost >= kPrimitiveCost * area * static_cast<float>(count);
  }

  template <class Sum, class Add>
  Sum reduce(Range range, const Sum& empty, const Add& add) const {
    const auto range_sum = [&](std::uint32_t begin, std::uint32_t end, Sum sum) {
      for (std::uint32_t i = begin; i < end; ++i) add(sum, load(order_[i]));
      return sum;
    };
    const std::uint32_t end = range.first + range.count;
    if (range.count < kParallelBinning) return range_sum(range.first, end, empty);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::uint32_t>(range.first, end, kParallelBinning / 4), empty,
        [&](const auto& part, Sum sum) {
          return range_sum(part.begin(), part.end(), std::move(sum));
        },
        [](Sum a, const Sum& b) {
          a.add(b);
          return a;
        });
  }

  Extent measure(Range range) const {
    return reduce(range, Extent{}, [](Extent& e, const Loaded& prim) { e.add(prim); });
  }

  Bins fill(const Binning& binning, Range range) const {
    return reduce(range, Bins(range.count >= kParallelBinning ? kBins : binning.bins_used),
                  [&](Bins& bins, const Loaded& prim) {
                    const Int4 at = binning.bins(prim);
                    for (int a = 0; a < 3; ++a) {
                      bins.box[at[a]][a].add(prim.lower, prim.upper);
                      ++bins.count[at[a]][a];
                    }
                  });
  }

  static Split best_split(const Bins& bins, int used) {
    Split best;
    for (int a = 0; a < 3; ++a) {
      std::array<float, kBins> right_cost{};
      Box4 box = empty_box4();
      std::uint32_t count = 0;
      for (int b = used - 1; b > 0; --b) {
        box.add(bins.box[b][a]);
        count += bins.count[b][a];
        right_cost[b] = count ? box.half_area() * static_cast<float>(count) : -1.0f;
      }
      box = empty_box4();
      count = 0;
      for (int b = 0; b + 1 < used; ++b) {
        box.add(bins.box[b][a]);
        count += bins.count[b][a];
        if (count == 0 || right_cost[b + 1] < 0.0f) continue;
        const float cost = box.half_area() * static_cast<float>(count) + right_cost[b + 1];
        if (cost < best.cost) best = {cost, a, b};
      }
    }
    return best;
  }

  /// Number of primitives that went left, in [1, count - 1]; extents of both sides.
  std::uint32_t partition(const Binning& binning, const Split& split, Range range,
                          Extent (&part)[2]) {
    if (split.axis < 0) {
      const std::uint32_t half = range.count / 2;
      part[0] = measure({range.first, half});
      part[1] = measure({range.first + half, range.count - half});
      return half;
    }
    // From both ends; what is looked at is measured on the way.
    std::uint32_t left = range.first, right = range.first + range.count;
    while (left < right) {
      const Loaded prim = load(order_[left]);
      const bool goes_right = binning.bins(prim)[split.axis] > split.last_left;
      part[goes_right].add(prim);
      if (goes_right) {
        std::swap(order_[left], order_[--right]);
      } else {
        ++left;
      }
    }
    return left - range.first;
  }

  std::vector<BinaryNode>& nodes_;
  std::vector<PrimitiveBox>& order_;
  std::uint32_t leaf_size_;
};

}  // namespace

BinaryTree build_binary_tree(std::vector<PrimitiveBox> boxes, std::uint32_t leaf_size) {
  BinaryTree tree;
  tree.order = std::move(boxes);
  const auto count = static_cast<std::uint32_t>(tree.order.size());
  tree.nodes.resize(2 * std::size_t{count} - 1);
  Builder(tree, leaf_size).build();
  return tree;
}

}  // namespace dapple
