// Which objects and materials the samples of each pixel hit, and how many samples: whole numbers,
// so that sums do not depend on the order of slices. In: hits. Out: slots of pixels, and all of
// them as one array, for checkpoints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dapple {

struct MatteSlot {
  std::uint32_t object = 0, material = 0;  ///< numbers of Scene::objects and Scene::materials
  std::uint32_t count = 0;                 ///< samples
  bool operator==(const MatteSlot&) const = default;
};

/// Slots of a pixel at most. Samples that would need one more count for nothing: which ones these
/// are depends only on the order of the pixel's own samples.
inline constexpr std::size_t kMaxMatteSlots = 32;

class MatteSums {
 public:
  explicit MatteSums(std::size_t pixels = 0) : slots_(pixels) {}

  /// Adds one sample. Different pixels may be added to in parallel.
  void add(std::size_t pixel, std::uint32_t object, std::uint32_t material);

  [[nodiscard]] std::size_t pixel_count() const { return slots_.size(); }
  /// The slots of a pixel, in the order in which they were first hit.
  [[nodiscard]] std::vector<MatteSlot> of_pixel(std::size_t pixel) const;

  /// For each pixel the number of its slots, and the slots.
  [[nodiscard]] std::vector<std::uint32_t> packed() const;

  /// What packed() returned, for so many pixels; numbers of objects and materials must be below
  /// those given. False if it is not that.
  bool unpack(std::span<const std::uint32_t> packed, std::size_t pixels,
              std::size_t objects = std::size_t{1} << 32,
              std::size_t materials = std::size_t{1} << 32);

 private:
  /// Most pixels have one slot, and need no memory besides it.
  struct Pixel {
    MatteSlot first;
    std::vector<MatteSlot> others;
  };

  std::vector<Pixel> slots_;
};

}  // namespace dapple
