#include "bake/inside/box_tree.hpp"

#include "sampling/point_order.hpp"

namespace dapple {

BoxTree::BoxTree(std::span<const Box3f> boxes) {
  if (boxes.empty()) return;
  std::vector<V3f> centers;
  centers.reserve(boxes.size());
  for (const Box3f& box : boxes) centers.push_back(box.center());
  order_ = order_along_curve(centers);
  std::vector<Box3f> level;
  level.reserve(boxes.size());
  for (const std::uint32_t i : order_) level.push_back(boxes[i]);
  levels_.push_back(std::move(level));
  while (levels_.back().size() > kWidth) {
    const std::vector<Box3f>& below = levels_.back();
    std::vector<Box3f> above((below.size() + kWidth - 1) / kWidth);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / kWidth].extendBy(below[i]);
    levels_.push_back(std::move(above));
  }
}

}  // namespace dapple
