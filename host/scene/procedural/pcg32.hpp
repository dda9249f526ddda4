// Random numbers for procedural scenes. In: a seed and a stream number; out: uniform numbers,
// points and directions. Only integers, +, -, *, / and sqrt are used, so that a seed gives the same
// bits on every machine; std distributions and libm's sines do not guarantee that.
#pragma once

#include <cassert>
#include <cmath>
#include <cstdint>

#include "dapple/scene.hpp"

namespace dapple {

/// PCG-XSH-RR 64/32 (O'Neill, PCG: A Family of Simple Fast Space-Efficient Statistically Good
/// Algorithms for Random Number Generation, 2014, section 6.3).
class Pcg32 {
 public:
  /// Each `stream` of a seed is an independent sequence. Each leaf uses its own stream, so that
  /// leaves can be made in any order and on any thread.
  explicit Pcg32(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(mix(seed + mix(stream))), increment_(2 * mix(stream ^ seed) + 1) {}

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto word = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return (word >> turn) | (word << ((32 - turn) & 31));
  }

  /// Uniform in [0, 1), a multiple of 2^-24.
  float unit() { return static_cast<float>(next() >> 8) * 0x1p-24f; }

  /// Uniform in [low, high).
  float between(float low, float high) { return low + (high - low) * unit(); }

  /// Uniform in [0, count), to within 2^-32 count.
  std::uint32_t below(std::uint32_t count) {
    assert(count > 0);
    return static_cast<std::uint32_t>((std::uint64_t{next()} * count) >> 32);
  }

 private:
  // The finalizer of SplitMix64 (Steele et al., Fast Splittable Pseudorandom Number Generators,
  // 2014). It gives very different states to consecutive seeds and streams.
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }

  std::uint64_t state_;
  std::uint64_t increment_;
};

/// Uniform in the unit ball, without a ball of radius 0.01 around the centre.
inline V3f point_in_ball(Pcg32& rng) {
  for (;;) {
    const float x = rng.between(-1, 1);
    const float y = rng.between(-1, 1);
    const float z = rng.between(-1, 1);
    const V3f point(x, y, z);
    if (const float r2 = point.length2(); r2 <= 1 && r2 > 1e-4f) return point;
  }
}

/// Uniform on the unit sphere.
inline V3f unit_vector(Pcg32& rng) {
  const V3f point = point_in_ball(rng);
  return point / std::sqrt(point.length2());
}

/// Uniform on the unit circle: the cosine and sine of a random angle.
inline V2f unit_circle(Pcg32& rng) {
  for (;;) {
    const float x = rng.between(-1, 1);
    const float y = rng.between(-1, 1);
    if (const float r2 = x * x + y * y; r2 <= 1 && r2 > 1e-4f) {
      const float r = std::sqrt(r2);
      return {x / r, y / r};
    }
  }
}

}  // namespace dapple
