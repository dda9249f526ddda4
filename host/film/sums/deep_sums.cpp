#include "film/sums/deep_sums.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace dapple {

void DeepSums::add(std::size_t pixel, float z) {
  std::vector<Slot>& slots = slots_[pixel];
  if (slots.empty()) slots.reserve(kMaxDeepSamples / 2);
  const auto behind = std::lower_bound(
      slots.begin(), slots.end(), z, [](const Slot& slot, float depth) { return slot.z < depth; });
  auto nearest = behind;
  if (nearest != slots.begin() && (nearest == slots.end() || z - (nearest - 1)->z < nearest->z - z))
    --nearest;
  if (!slots.empty() && std::fabs(nearest->z - z) <= kDeepMerge * std::fabs(nearest->z)) {
    ++nearest->count;
    nearest->z += (z - nearest->z) / static_cast<float>(nearest->count);
    return;
  }
  slots.insert(behind, {z, 1});
  if (slots.size() > kMaxDeepSamples) merge_nearest(slots);
}

void DeepSums::merge_nearest(std::vector<Slot>& slots) {
  std::size_t best = 1;
  for (std::size_t i = 2; i < slots.size(); ++i) {
    const float gap = slots[i].z - slots[i - 1].z, smallest = slots[best].z - slots[best - 1].z;
    if (gap * std::fabs(slots[best].z) < smallest * std::fabs(slots[i].z)) best = i;
  }
  Slot &front = slots[best - 1], &back = slots[best];
  const auto a = static_cast<float>(front.count), b = static_cast<float>(back.count);
  front = {front.z + (back.z - front.z) * (b / (a + b)), front.count + back.count};
  slots.erase(slots.begin() + static_cast<std::ptrdiff_t>(best));
}

DeepAlpha DeepSums::alpha(const std::vector<std::uint32_t>& samples) const {
  DeepAlpha deep;
  deep.first.reserve(slots_.size() + 1);
  deep.samples.reserve(std::transform_reduce(slots_.begin(), slots_.end(), std::size_t{0},
                                             std::plus<>(),
                                             [](const auto& slots) { return slots.size(); }));
  for (std::size_t p = 0; p < slots_.size(); ++p) {
    deep.first.push_back(deep.samples.size());
    std::uint32_t left = samples[p];  // samples that reach the depth
    for (const Slot& slot : slots_[p]) {
      deep.samples.push_back({slot.z, static_cast<float>(double{1} * slot.count / left)});
      left -= slot.count;
    }
  }
  deep.first.push_back(deep.samples.size());
  return deep;
}

}  // namespace dapple
