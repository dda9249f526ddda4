#include "bake/placement_choice.hpp"

#include <algorithm>
#include <bit>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kMixings = 4;

/// Number `index` of a random order of 0 to `count` - 1. Mixing is a bijection of the numbers below
/// a power of two, and goes on until the number is below `count`; the rotation makes all equally
/// likely.
std::uint32_t shuffled(std::uint32_t index, std::uint32_t count, std::uint32_t random) {
  const std::uint32_t mask = std::bit_ceil(count) - 1;
  const auto half = std::max(1u, static_cast<std::uint32_t>(std::bit_width(mask)) / 2);
  do {
    for (std::uint32_t i = 0; i < kMixings; ++i) {
      const std::uint32_t bits = hash_of(random, i);
      index = (index * (bits >> 16 | 1) + bits) & mask;
      index ^= index >> half;
    }
  } while (index >= count);
  return (index + hash_of(random, kMixings) % count) % count;
}

}  // namespace

std::uint32_t placement_of_sample(std::uint32_t sample, std::uint32_t placements,
                                  std::uint32_t random) {
  if (placements < 2) return 0;
  return shuffled(sample % placements, placements, hash_of(random, sample / placements));
}

}  // namespace dapple
