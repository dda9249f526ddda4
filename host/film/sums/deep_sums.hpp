// Where along its camera rays a pixel is opaque. In: depths of what the samples hit. Out: the
// opacity of a few depths of each pixel. A sample stops at a surface as often as the surface's
// opacity says (k_buffer.clh), so that shares of samples are alphas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/film.hpp"

namespace dapple {

/// Depths of a pixel at most. Then the two nearest to each other are merged.
inline constexpr std::size_t kMaxDeepSamples = 16;

/// Depths are merged that differ by less, relative to themselves.
inline constexpr float kDeepMerge = 1e-3f;

class DeepSums {
 public:
  DeepSums() = default;
  explicit DeepSums(std::size_t pixels) : slots_(pixels) {}

  /// Adds one sample that hit something at depth `z`. The depths of a pixel depend on the order of
  /// its samples. Different pixels may be added to in parallel.
  void add(std::size_t pixel, float z);

  [[nodiscard]] bool empty() const { return slots_.empty(); }

  /// `samples`: of each pixel, those that hit nothing included.
  [[nodiscard]] DeepAlpha alpha(const std::vector<std::uint32_t>& samples) const;

 private:
  struct Slot {
    float z;  ///< mean of its samples
    std::uint32_t count;
  };

  /// Makes one slot of the two neighbours that are nearest to each other, relative to their depth.
  static void merge_nearest(std::vector<Slot>& slots);

  std::vector<std::vector<Slot>> slots_;  ///< by pixel, front to back
};

}  // namespace dapple
