#include "bvh/refit/vertex_places.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1 << 14;
constexpr float kSteps = 1 << 17;
/// Bits of the table for each vertex: many of few vertices, whose number would be vague else.
constexpr std::size_t kBits = 2, kBitsOfFew = 32, kFew = 1 << 16;

Box3f bounds_of(std::span<const V3f> positions) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, positions.size(), kGrain), Box3f(),
      [&](const auto& range, Box3f box) {
        for (std::size_t v = range.begin(); v < range.end(); ++v) box.extendBy(positions[v]);
        return box;
      },
      [](Box3f a, const Box3f& b) {
        a.extendBy(b);
        return a;
      });
}

/// The finalizer of splitmix64 (Steele et al., "Fast Splittable Pseudorandom Number Generators",
/// 2014).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

}  // namespace

double share_of_places(std::span<const V3f> positions) {
  const std::size_t count = positions.size();
  if (count == 0) return 1;
  const Box3f box = bounds_of(positions);
  const V3f size = box.max - box.min;
  const float longest = std::max({size.x, size.y, size.z});
  const float steps = longest > 0 ? kSteps / longest : 0;
  const std::size_t bits = std::bit_ceil(count * (count < kFew ? kBitsOfFew : kBits));
  std::vector<std::uint64_t> table(std::max<std::size_t>(bits / 64, 1));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const V3f at = (positions[v] - box.min) * steps;
      std::uint64_t cell = 0;
      for (int axis = 0; axis < 3; ++axis)
        cell = cell << 18 | static_cast<std::uint64_t>(std::lround(std::max(at[axis], 0.0f)));
      const std::uint64_t bit = mixed(cell) & (64 * table.size() - 1);
      std::atomic_ref(table[bit / 64])
          .fetch_or(std::uint64_t{1} << bit % 64, std::memory_order_relaxed);
    }
  });
  std::size_t taken = 0;
  for (const std::uint64_t word : table) taken += static_cast<std::size_t>(std::popcount(word));
  const auto all = static_cast<double>(64 * table.size());
  const double free = std::max(all - static_cast<double>(taken), 1.0);
  return -all * std::log(free / all) / static_cast<double>(count);
}

}  // namespace dapple
