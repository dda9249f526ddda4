// Sums of motion vectors over the samples of each pixel, in fixed point, so that they do not depend
// on the order of slices. In: motions in pixels. Out: their means.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"
#include "film/sums/wrapped_sum.hpp"

namespace dapple {

class MotionSums {
 public:
  MotionSums() = default;
  explicit MotionSums(std::size_t pixels) : sums_(pixels) {}

  /// Adds one sample, clamped to kMax pixels; one that is not a number counts as 0. Different
  /// pixels may be added to in parallel.
  void add(std::size_t pixel, const Imath::V2d& motion) {
    for (int axis = 0; axis < 2; ++axis)
      if (!std::isnan(motion[axis]))
        sums_[pixel][static_cast<std::size_t>(axis)] +=
            std::llround(std::clamp(motion[axis], -kMax, kMax) * kScale);
  }
  /// The mean of `count` samples, pixels; `axis` 0 or 1.
  [[nodiscard]] double mean(std::size_t pixel, std::size_t axis, double count) const {
    return static_cast<double>(sums_[pixel][axis]) / (kScale * count);
  }
  [[nodiscard]] bool empty() const { return sums_.empty(); }

  /// The sums of a pixel, in fixed point, for checkpoints and for adding up shards.
  using Sum = std::array<std::int64_t, 2>;
  explicit MotionSums(std::vector<Sum> sums) : sums_(std::move(sums)) {}
  [[nodiscard]] std::span<const Sum> values() const { return sums_; }
  void add(std::size_t pixel, const Sum& sum) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      sums_[pixel][axis] = wrapped_sum(sums_[pixel][axis], sum[axis]);
  }

 private:
  /// 2^24 samples of the largest motion fit 63 bits.
  static constexpr double kMax = 1 << 20, kScale = 1 << 18;

  std::vector<Sum> sums_;
};

}  // namespace dapple
