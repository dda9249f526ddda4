#include "film/sums/matte_sums.hpp"

#include <algorithm>

namespace dapple {
namespace {

constexpr std::size_t kSlotNumbers = 4;

}  // namespace

MatteSlot* MatteSums::Pixel::find(std::uint32_t object, std::uint32_t material) {
  const auto is_it = [&](const MatteSlot& slot) {
    return slot.object == object && slot.material == material;
  };
  if (first.count && is_it(first)) return &first;
  const auto found = std::find_if(others.begin(), others.end(), is_it);
  return found == others.end() ? nullptr : &*found;
}

void MatteSums::Pixel::append(const MatteSlot& slot) {
  if (first.count == 0)
    first = slot;
  else
    others.push_back(slot);
}

std::vector<MatteSlot> MatteSums::Pixel::slots() const {
  std::vector<MatteSlot> all;
  if (first.count == 0) return all;
  all.push_back(first);
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

void MatteSums::add(std::size_t pixel, std::uint32_t object, std::uint32_t material,
                    std::uint32_t sample) {
  Pixel& slots = pixels_[pixel];
  if (MatteSlot* slot = slots.find(object, material))
    ++slot->count;
  else if (slots.size() < max_slots_)
    slots.append({object, material, 1, sample});
}

void MatteSums::add(std::size_t pixel, const std::vector<MatteSlot>& more) {
  Pixel& slots = pixels_[pixel];
  for (const MatteSlot& one : more) {
    MatteSlot* slot = slots.find(one.object, one.material);
    if (!slot) {
      slots.append(one);
      continue;
    }
    slot->count += one.count;
    slot->first = std::min(slot->first, one.first);
  }
}

void MatteSums::keep_first() {
  for (Pixel& pixel : pixels_) {
    if (pixel.size() < 2) continue;
    std::vector<MatteSlot> slots = pixel.slots();
    std::sort(slots.begin(), slots.end(),
              [](const MatteSlot& a, const MatteSlot& b) { return a.first < b.first; });
    if (slots.size() > kMaxMatteSlots) slots.resize(kMaxMatteSlots);
    pixel.first = slots[0];
    pixel.others.assign(slots.begin() + 1, slots.end());
  }
}

std::vector<std::uint32_t> MatteSums::packed() const {
  std::vector<std::uint32_t> values;
  for (const Pixel& pixel : pixels_) {
    values.push_back(static_cast<std::uint32_t>(pixel.size()));
    for (const MatteSlot& slot : pixel.slots())
      values.insert(values.end(), {slot.object, slot.material, slot.count, slot.first});
  }
  return values;
}

bool MatteSums::unpack(std::span<const std::uint32_t> packed, std::size_t pixels,
                       std::size_t objects, std::size_t materials) {
  pixels_.assign(pixels, {});
  std::size_t at = 0;
  for (Pixel& pixel : pixels_) {
    if (at == packed.size()) return false;
    const std::size_t count = packed[at++];
    if (kSlotNumbers * count > packed.size() - at) return false;
    for (std::size_t i = 0; i < count; ++i, at += kSlotNumbers) {
      const MatteSlot slot{packed[at], packed[at + 1], packed[at + 2], packed[at + 3]};
      if (slot.object >= objects || slot.material >= materials || slot.count == 0) return false;
      pixel.append(slot);
    }
  }
  return at == packed.size();
}

}  // namespace dapple
