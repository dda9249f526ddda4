// Which camera samples of a picture have their rays traced exactly, too. In: pixel and number of
// the sample. Out: whether. Depends on nothing else, so neither on threads nor on slices or crops.
#pragma once

#include <cstdint>

namespace dapple {

/// Side in pixels of a unit: its samples of one number are chosen together, so that their exact
/// rays are coherent.
inline constexpr std::uint32_t kBiasUnit = 8;

/// A share of all (unit, sample) pairs, evenly distributed over units and samples.
class ExactSamples {
 public:
  /// `share`: [0,1].
  explicit ExactSamples(double share) : below_(static_cast<std::uint64_t>(share * 4294967296.0)) {}

  /// `x`, `y`: pixel of the whole picture. `sample`: of the camera rays of the pixel.
  [[nodiscard]] bool has(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const {
    // A Kronecker sequence of three dimensions, modulo 2^32: powers of the root of x^4 = x + 1
    // (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
    constexpr std::uint32_t kColumn = 3518319155u, kRow = 2882110345u, kSample = 2360945575u;
    const std::uint32_t position =
        x / kBiasUnit * kColumn + y / kBiasUnit * kRow + (sample + 1) * kSample;
    return position < below_;
  }

 private:
  std::uint64_t below_;
};

}  // namespace dapple
