#include "bvh/refit/refit_record.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dapple {
namespace {

std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
}

bool is_cut_off(const WideTree& tree, std::uint32_t node) {
  return node > 0 && tree.nodes[node].primitives <= kRigidPrimitives;
}

/// Returns which nodes are above the subtrees or are roots of subtrees.
std::vector<bool> find_upper(const WideTree& tree) {
  std::vector<bool> upper(tree.nodes.size(), false);
  upper[0] = true;
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    if (!upper[n] || is_cut_off(tree, n)) continue;
    for (const WideChild& child : tree.children_of(tree.nodes[n])) {
      if (child.count == 0) upper[child.first] = true;
    }
  }
  return upper;
}

}  // namespace

void KeptOpacity::keep(unsigned slot, const V3f& axes, const SurfaceAreas& areas, const Box3f& box,
                       float factor) {
  for (int axis = 0; axis < 3; ++axis) {
    const float sum = areas.front[axis] + areas.back[axis] + areas.other[axis];
    const float share = sum > 0.0f ? axes[axis] * face_area(box, axis) / sum : 1.0f;
    share_[axis][slot] =
        static_cast<std::uint16_t>(std::lround(std::clamp(share * kShareOne, 0.0f, 65535.0f)));
  }
  factor_[slot] = byte_of((factor - 0.6f) * 255.0f);
}

SmallMap::SmallMap(const CoverageMap& map) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto& cells = map.transmittance[axis];
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column) {
        const float* at = &cells[2 * row * kMapSize + 2 * column];
        const float sum = at[0] + at[1] + at[kMapSize] + at[kMapSize + 1];
        opacity_[axis][row * kSize + column] = byte_of(255.0f * (1.0f - 0.25f * sum));
      }
    }
  }
}

CoverageMap SmallMap::with_means(const V3f& axes) const {
  CoverageMap map;
  for (int axis = 0; axis < 3; ++axis) {
    unsigned sum = 0;
    for (const std::uint8_t opacity : opacity_[axis]) sum += opacity;
    // A map that was empty may have content now: all cells get the same opacity.
    const float uniform = sum == 0 ? axes[axis] : 0.0f;
    const float scale =
        sum == 0 ? 0.0f : axes[axis] * static_cast<float>(kSize * kSize) / static_cast<float>(sum);
    for (int row = 0; row < kMapSize; ++row) {
      for (int column = 0; column < kMapSize; ++column) {
        const float opacity = opacity_[axis][row / 2 * kSize + column / 2];
        map.transmittance[axis][row * kMapSize + column] =
            1.0f - std::min(1.0f, uniform + scale * opacity);
      }
    }
  }
  return map;
}

void KeptSubtree::keep(const CoverageMap& made, const SurfaceAreas& areas, const Box3f& box) {
  map = SmallMap(made);
  layers = layers_in(areas, box);
  for (int axis = 0; axis < 3; ++axis) axes[axis] = made.mean_opacity(axis);
}

V3f KeptSubtree::axes_at(const V3f& layers_now) const {
  V3f now;
  for (int axis = 0; axis < 3; ++axis) {
    const float share = layers[axis] > 0.0f ? axes[axis] / layers[axis] : 1.0f;
    now[axis] = std::min(1.0f, share * layers_now[axis]);
  }
  return now;
}

std::size_t RefitRecord::subtree_at(std::uint32_t node) const {
  const auto at = std::lower_bound(
      subtrees.begin(), subtrees.end(), node,
      [](const KeptSubtree& subtree, std::uint32_t n) { return subtree.node < n; });
  assert(at != subtrees.end() && at->node == node);
  return static_cast<std::size_t>(at - subtrees.begin());
}

void cut_subtrees(const WideTree& tree, RefitRecord& record) {
  const std::vector<bool> upper = find_upper(tree);
  std::vector<std::uint32_t> new_index(tree.nodes.size(), 0);
  for (std::uint32_t n = 0; n < upper.size(); ++n) {
    if (!upper[n]) continue;
    new_index[n] = static_cast<std::uint32_t>(record.upper_nodes.size());
    record.upper_nodes.push_back(n);
    if (is_cut_off(tree, n)) record.subtrees.push_back({n, {}});
  }
  for (const std::uint32_t n : record.upper_nodes) {
    WideNode node = tree.nodes[n];
    if (is_cut_off(tree, n)) node.child_count = 0;
    node.first_child = static_cast<std::uint32_t>(record.upper.children.size());
    if (node.child_count > 0) {
      for (WideChild child : tree.children_of(tree.nodes[n])) {
        if (child.count == 0) child.first = new_index[child.first];
        record.upper.children.push_back(child);
      }
    }
    record.upper.nodes.push_back(node);
  }
}

V3f layers_in(const SurfaceAreas& areas, const Box3f& box) {
  V3f layers(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const float face = face_area(box, axis);
    if (face > 0.0f)
      layers[axis] = (areas.front[axis] + areas.back[axis] + areas.other[axis]) / face;
  }
  return layers;
}

}  // namespace dapple
