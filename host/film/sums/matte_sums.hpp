// Which objects and materials the samples of each pixel hit, and how many samples: whole numbers,
// so that sums do not depend on the order of slices and shards. In: hits. Out: slots of pixels, and
// all of them as one array, for checkpoints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dapple {

struct MatteSlot {
  std::uint32_t object = 0, material = 0;  ///< numbers of Scene::objects and Scene::materials
  std::uint32_t count = 0;                 ///< samples
  std::uint32_t first = 0;                 ///< the number of the first of them
  bool operator==(const MatteSlot&) const = default;
};

/// Slots of a pixel of a picture at most: those whose first samples come first. Samples that would
/// need one more count for nothing. 4 kB; each sample looks through half of them.
inline constexpr std::size_t kMaxMatteSlots = 256;

/// For shards that begin later: earlier samples decide which slots the picture has.
inline constexpr std::size_t kAnyMatteSlots = ~std::size_t{0};

class MatteSums {
 public:
  explicit MatteSums(std::size_t pixels = 0, std::size_t max_slots = kMaxMatteSlots)
      : pixels_(pixels), max_slots_(max_slots) {}

  /// Adds one sample; those of a pixel come in ascending order. Different pixels may be added to in
  /// parallel.
  void add(std::size_t pixel, std::uint32_t object, std::uint32_t material, std::uint32_t sample);

  /// Adds another shard's slots of a pixel, in any order of shards.
  void add(std::size_t pixel, const std::vector<MatteSlot>& slots);

  /// Keeps the first kMaxMatteSlots of each pixel, in the order of their first samples.
  void keep_first();

  [[nodiscard]] std::size_t pixel_count() const { return pixels_.size(); }
  /// The slots of a pixel, in the order in which they were first hit.
  [[nodiscard]] std::vector<MatteSlot> of_pixel(std::size_t pixel) const {
    return pixels_[pixel].slots();
  }
  /// Calls `use` with each of them.
  template <class Use>
  void for_each_slot(std::size_t pixel, const Use& use) const {
    const Pixel& of_pixel = pixels_[pixel];
    if (of_pixel.first.count == 0) return;
    use(of_pixel.first);
    for (const MatteSlot& slot : of_pixel.others) use(slot);
  }

  /// For each pixel the number of its slots, and the slots.
  [[nodiscard]] std::vector<std::uint32_t> packed() const;

  /// What packed() returned, for so many pixels; numbers of objects and materials must be below
  /// those given, and counts not 0. False if it is not that.
  bool unpack(std::span<const std::uint32_t> packed, std::size_t pixels,
              std::size_t objects = std::size_t{1} << 32,
              std::size_t materials = std::size_t{1} << 32);

 private:
  /// Most pixels have one slot, and need no memory besides it. A slot without samples is free.
  struct Pixel {
    MatteSlot first;
    std::vector<MatteSlot> others;
    [[nodiscard]] std::size_t size() const { return first.count ? 1 + others.size() : 0; }
    /// The slot of an object and material, or nullptr.
    MatteSlot* find(std::uint32_t object, std::uint32_t material);
    void append(const MatteSlot& slot);
    [[nodiscard]] std::vector<MatteSlot> slots() const;
  };

  std::vector<Pixel> pixels_;
  std::size_t max_slots_;
};

}  // namespace dapple
