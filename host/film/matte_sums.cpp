#include "film/matte_sums.hpp"

#include <algorithm>

namespace dapple {

void MatteSums::add(std::size_t pixel, std::uint32_t object, std::uint32_t material) {
  Pixel& slots = slots_[pixel];
  const auto is_it = [&](const MatteSlot& slot) {
    return slot.object == object && slot.material == material;
  };
  if (slots.first.count == 0) slots.first = {object, material, 0};
  if (is_it(slots.first)) {
    ++slots.first.count;
    return;
  }
  const auto found = std::find_if(slots.others.begin(), slots.others.end(), is_it);
  if (found != slots.others.end())
    ++found->count;
  else if (1 + slots.others.size() < kMaxMatteSlots)
    slots.others.push_back({object, material, 1});
}

std::vector<MatteSlot> MatteSums::of_pixel(std::size_t pixel) const {
  std::vector<MatteSlot> slots;
  if (slots_[pixel].first.count == 0) return slots;
  slots.push_back(slots_[pixel].first);
  slots.insert(slots.end(), slots_[pixel].others.begin(), slots_[pixel].others.end());
  return slots;
}

std::vector<std::uint32_t> MatteSums::packed() const {
  std::vector<std::uint32_t> values;
  for (std::size_t p = 0; p < slots_.size(); ++p) {
    const std::vector<MatteSlot> slots = of_pixel(p);
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
  for (Pixel& slots : slots_) {
    if (at == packed.size() || packed[at] > kMaxMatteSlots) return false;
    const std::size_t count = packed[at++];
    if (3 * count > packed.size() - at) return false;
    for (std::size_t i = 0; i < count; ++i, at += 3) {
      const MatteSlot slot{packed[at], packed[at + 1], packed[at + 2]};
      if (slot.object >= objects || slot.material >= materials || slot.count == 0) return false;
      if (i == 0)
        slots.first = slot;
      else
        slots.others.push_back(slot);
    }
  }
  return at == packed.size();
}

}  // namespace dapple
