// Binned SAH (Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007).
// A node's place in the array follows from its range alone, so that subtrees can be built
// in parallel without a shared counter and come out the same.
#include "bvh/binary_tree.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

namespace dapple {
namespace {

constexpr int kBins = 16;
constexpr std::uint32_t kParallelBinning = 1u << 16;
constexpr std::uint32_t kParallelSubtree = 1u << 12;
/// Below this depth ranges are halved, which bounds the depth of hostile input.
constexpr int kDeepest = 48;
/// Cost of a triangle test over that of a box test; leaves of 8 lanes are cheap.
constexpr float kPrimitiveCost = 0.6f;

V3f centre(const PrimitiveBox& box) { return (box.lower + box.upper) * 0.5f; }

struct Extent {
  Box3f box, centres;
  void add(const PrimitiveBox& prim) {
    box.extendBy(prim.lower);
    box.extendBy(prim.upper);
    centres.extendBy(centre(prim));
  }
  void add(const Extent& other) {
    box.extendBy(other.box);
    centres.extendBy(other.centres);
  }
};

struct Bin {
  Box3f box;
  std::uint32_t count = 0;
};

struct Bins {
  std::array<std::array<Bin, kBins>, 3> axis;
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < kBins; ++b) {
        axis[a][b].box.extendBy(other.axis[a][b].box);
        axis[a][b].count += other.axis[a][b].count;
      }
    }
  }
};

/// Maps centres to bins; an axis along which all centres agree has scale 0.
struct Binning {
  V3f start, scale;
  explicit Binning(const Box3f& centres) : start(centres.min), scale(0.0f) {
    const V3f size = centres.max - centres.min;
    for (int a = 0; a < 3; ++a) {
      if (size[a] > 0.0f && kBins / size[a] < 1e30f) scale[a] = kBins * 0.99999f / size[a];
    }
  }
  int bin(const PrimitiveBox& prim, int a) const {
    const float at = ((prim.lower[a] + prim.upper[a]) * 0.5f - start[a]) * scale[a];
    return std::clamp(static_cast<int>(at), 0, kBins - 1);
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

  void build(std::uint32_t index, std::uint32_t first, std::uint32_t count, int depth) {
    const Extent extent = measure(first, count);
    BinaryNode& node = nodes_[index];
    node = {extent.box, first, count, 0, 0};
    if (count == 1) return;
    const Binning binning(extent.centres);
    const Split split = depth < kDeepest ? best_split(fill(binning, first, count)) : Split{};
    const float area = half_area(extent.box);
    const bool as_leaf_is_cheaper =
        split.axis < 0 ||
        area + kPrimitiveCost * split.cost >= kPrimitiveCost * area * static_cast<float>(count);
    if (count <= leaf_size_ && as_leaf_is_cheaper) return;
    const std::uint32_t left_count = partition(binning, split, first, count);
    node.left = index + 1;
    node.right = index + 2 * left_count;
    const auto left = [&] { build(node.left, first, left_count, depth + 1); };
    const auto right = [&] {
      build(node.right, first + left_count, count - left_count, depth + 1);
    };
    if (count > kParallelSubtree) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

 private:
  template <class Sum, class Add>
  Sum reduce(std::uint32_t first, std::uint32_t count, const Sum& empty, const Add& add) const {
    const auto range_sum = [&](std::uint32_t begin, std::uint32_t end, Sum sum) {
      for (std::uint32_t i = begin; i < end; ++i) add(sum, order_[i]);
      return sum;
    };
    if (count < kParallelBinning) return range_sum(first, first + count, empty);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::uint32_t>(first, first + count, kParallelBinning / 4), empty,
        [&](const auto& range, Sum sum) {
          return range_sum(range.begin(), range.end(), std::move(sum));
        },
        [](Sum a, const Sum& b) {
          a.add(b);
          return a;
        });
  }

  Extent measure(std::uint32_t first, std::uint32_t count) const {
    return reduce(first, count, Extent{}, [](Extent& e, const PrimitiveBox& prim) { e.add(prim); });
  }

  Bins fill(const Binning& binning, std::uint32_t first, std::uint32_t count) const {
    return reduce(first, count, Bins{}, [&](Bins& bins, const PrimitiveBox& prim) {
      for (int a = 0; a < 3; ++a) {
        Bin& bin = bins.axis[a][binning.bin(prim, a)];
        bin.box.extendBy(prim.lower);
        bin.box.extendBy(prim.upper);
        ++bin.count;
      }
    });
  }

  static Split best_split(const Bins& bins) {
    Split best;
    for (int a = 0; a < 3; ++a) {
      const auto& axis = bins.axis[a];
      std::array<float, kBins> right_cost{};
      Box3f box;
      std::uint32_t count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        box.extendBy(axis[b].box);
        count += axis[b].count;
        right_cost[b] = count ? half_area(box) * static_cast<float>(count) : -1.0f;
      }
      box = Box3f();
      count = 0;
      for (int b = 0; b + 1 < kBins; ++b) {
        box.extendBy(axis[b].box);
        count += axis[b].count;
        if (count == 0 || right_cost[b + 1] < 0.0f) continue;
        const float cost = half_area(box) * static_cast<float>(count) + right_cost[b + 1];
        if (cost < best.cost) best = {cost, a, b};
      }
    }
    return best;
  }

  /// Number of primitives that went left, in [1, count - 1].
  std::uint32_t partition(const Binning& binning, const Split& split, std::uint32_t first,
                          std::uint32_t count) {
    if (split.axis < 0) return count / 2;
    const auto begin = order_.begin() + first;
    const auto middle = std::partition(begin, begin + count, [&](const PrimitiveBox& prim) {
      return binning.bin(prim, split.axis) <= split.last_left;
    });
    return static_cast<std::uint32_t>(middle - begin);
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
  Builder(tree, leaf_size).build(0, 0, count, 0);
  return tree;
}

}  // namespace dapple
