#include "bvh/refit/traversal_cost.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/build/primitive_box.hpp"
#include "bvh/build/quantize_boxes.hpp"

namespace dapple {
namespace {

/// Of so many vertices and nodes, evenly spread, the rest is known.
constexpr std::size_t kSamples = std::size_t{1} << 14;

std::size_t stride_of(std::size_t count) { return (count + kSamples - 1) / kSamples; }

/// Half the surface area of a box in which evenly spread points would have the mean absolute
/// deviations of the mesh's: far ones hardly count.
double robust_area(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size(), stride = stride_of(count);
  const auto mean_of = [&](const auto& value) {
    V3d sum(0, 0, 0);
    double samples = 0;
    for (std::size_t i = 0; i < count; i += stride, ++samples) sum += value(mesh.positions[i]);
    return sum / std::max(samples, 1.0);
  };
  const V3d mean = mean_of([](const V3f& p) { return V3d(p); });
  const V3d deviation = mean_of([&](const V3f& p) {
    const V3d off = V3d(p) - mean;
    return V3d(std::fabs(off.x), std::fabs(off.y), std::fabs(off.z));
  });
  return half_area(Box3f(V3f(0, 0, 0), V3f(4.0 * deviation)));  // L / 4 is that of a side L
}

}  // namespace

double traversal_cost(std::span<const BvhNode> nodes, const Mesh& mesh) {
  const double area = robust_area(mesh);
  if (!(area > 0)) return 1;
  const std::size_t stride = stride_of(nodes.size());
  double visits = 0, seen = 0;
  for (std::size_t n = 0; n < nodes.size(); n += stride, ++seen) {
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      if (!(nodes[n].inner_mask >> slot & 1)) continue;
      visits += std::min(half_area(child_box(nodes[n], slot)) / area, 1.0);
    }
  }
  return 1 + visits * static_cast<double>(nodes.size()) / std::max(seen, 1.0);
}

}  // namespace dapple
