#include "film/matte_sums.hpp"

#include <algorithm>

namespace dapple {

void MatteSums::add(std::size_t pixel, std::uint32_t object, std::uint32_t material) {
  std::vector<MatteSlot>& slots = slots_[pixel];
  const auto found = std::find_if(slots.begin(), slots.end(), [&](const MatteSlot& slot) {
    return slot.object == object && slot.material == material;
  });
  if (found != slots.end())
    ++found->count;
  else if (slots.size() < kMaxMatteSlots)
    slots.push_back({object, material, 1});
}

std::vector<std::uint32_t> MatteSums::packed() const {
  std::vector<std::uint32_t> values;
  for (const std::vector<MatteSlot>& slots : slots_) {
    values.push_back(static_cast<std::uint32_t>(slots.size()));
    for (const MatteSlot& slot : slots)
      values.insert(values.end(), {slot.object, slot.material, slot.count});
  }
  return values;
}

bool MatteSums::unpack(std::span<const std::uint32_t> packed, std::size_t pixels,
                       std::size_t objects, std::size_t materials) {
  slots_.assign(pixels, {});
  std::size_t at = 0;
  for (std::vector<MatteSlot>& slots : slots_) {
    if (at == packed.size() || packed[at] > kMaxMatteSlots) return false;
    slots.resize(packed[at++]);
    if (3 * slots.size() > packed.size() - at) return false;
    for (MatteSlot& slot : slots) {
      slot = {packed[at], packed[at + 1], packed[at + 2]};
      at += 3;
      if (slot.object >= objects || slot.material >= materials) return false;
    }
  }
  return at == packed.size();
}

}  // namespace dapple
