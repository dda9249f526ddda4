// A bounding volume hierarchy over boxes, for queries on the host. In: boxes. Out: those that a
// query overlaps. Boxes in Morton order are joined four at a time, as in Lauterbach et al., "Fast
// BVH Construction on GPUs", 2009.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

class BoxTree {
 public:
  BoxTree() = default;
  /// Boxes must not be empty. Linear.
  explicit BoxTree(std::span<const Box3f> boxes);

  /// Calls visit(index) for each box for which overlaps(box) is true. `overlaps` must be true for a
  /// box that contains one for which it is.
  template <class Overlaps, class Visit>
  void visit(const Overlaps& overlaps, const Visit& visit) const {
    if (!levels_.empty()) visit_range(levels_.size() - 1, 0, kWidth, overlaps, visit);
  }

 private:
  static constexpr std::size_t kWidth = 4;

  template <class Overlaps, class Visit>
  void visit_range(std::size_t level, std::size_t begin, std::size_t end, const Overlaps& overlaps,
                   const Visit& visit) const {
    const std::vector<Box3f>& boxes = levels_[level];
    for (std::size_t i = begin; i < std::min(end, boxes.size()); ++i) {
      if (!overlaps(boxes[i])) continue;
      if (level == 0)
        visit(order_[i]);
      else
        visit_range(level - 1, kWidth * i, kWidth * (i + 1), overlaps, visit);
    }
  }

  std::vector<std::uint32_t> order_;        ///< index of each box of the first level
  std::vector<std::vector<Box3f>> levels_;  ///< the last has up to kWidth boxes
};

}  // namespace dapple
