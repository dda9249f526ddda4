#include "film/matte_sums.hpp"

#include <algorithm>

namespace dapple {

namespace {

constexpr std::size_t kSlotNumbers = 4;

/// The slot of an object and material, or nullptr.
MatteSlot* find(std::vector<MatteSlot>& slots, std::uint32_t object, std::uint32_t material) {
  const auto found = std::find_if(slots.begin(), slots.end(), [&](const MatteSlot& slot) {
    return slot.object == object && slot.material == material;
  });
  return found == slots.end() ? nullptr : &*found;
}

}  // namespace

void MatteSums::add(std::size_t pixel, std::uint32_t object, std::uint32_t material,
                    std::uint32_t sample) {
  std::vector<MatteSlot>& slots = slots_[pixel];
  if (MatteSlot* slot = find(slots, object, material))
    ++slot->count;
  else if (slots.size() < max_slots_)
    slots.push_back({object, material, 1, sample});
}

void MatteSums::add(std::size_t pixel, const std::vector<MatteSlot>& more) {
  std::vector<MatteSlot>& slots = slots_[pixel];
  for (const MatteSlot& one : more) {
    MatteSlot* slot = find(slots, one.object, one.material);
    if (!slot) {
      slots.push_back(one);
      continue;
    }
    slot->count += one.count;
    slot->first = std::min(slot->first, one.first);
  }
}

void MatteSums::keep_first() {
  for (std::vector<MatteSlot>& slots : slots_) {
    std::sort(slots.begin(), slots.end(),
              [](const MatteSlot& a, const MatteSlot& b) { return a.first < b.first; });
    if (slots.size() > kMaxMatteSlots) slots.resize(kMaxMatteSlots);
  }
}

std::vector<std::uint32_t> MatteSums::packed() const {
  std::vector<std::uint32_t> values;
  for (const std::vector<MatteSlot>& slots : slots_) {
    values.push_back(static_cast<std::uint32_t>(slots.size()));
    for (const MatteSlot& slot : slots)
      values.insert(values.end(), {slot.object, slot.material, slot.count, slot.first});
  }
  return values;
}

bool MatteSums::unpack(std::span<const std::uint32_t> packed, std::size_t pixels,
                       std::size_t objects, std::size_t materials) {
  slots_.assign(pixels, {});
  std::size_t at = 0;
  for (std::vector<MatteSlot>& slots : slots_) {
    if (at == packed.size()) return false;
    const std::size_t count = packed[at++];
    if (kSlotNumbers * count > packed.size() - at) return false;
    slots.resize(count);
    for (MatteSlot& slot : slots) {
      slot = {packed[at], packed[at + 1], packed[at + 2], packed[at + 3]};
      at += kSlotNumbers;
      if (slot.object >= objects || slot.material >= materials || slot.count == 0) return false;
    }
  }
  return at == packed.size();
}

}  // namespace dapple
