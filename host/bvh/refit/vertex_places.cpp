#include "bvh/refit/vertex_places.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1 << 14;
constexpr float kSteps = 1 << 20;
/// Bits of the table for each vertex: many of few vertices, whose number would be vague else. Of
/// many vertices those at an eighth of all places tell enough.
constexpr std::size_t kBits = 2, kBitsOfFew = 32, kFew = 1 << 16;
constexpr std::size_t kMany = 1 << 18, kPartOfMany = 8;

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
  const float steps =
      longest > 0 ? std::min(kSteps / longest, std::numeric_limits<float>::max()) : 0;
  const std::size_t part = count < kMany ? 1 : kPartOfMany;
  const std::size_t bits = std::bit_ceil(count * (count < kFew ? kBitsOfFew : kBits) / part);
  std::vector<std::uint64_t> table(std::max<std::size_t>(bits / 64, 1));
  std::atomic<std::size_t> vertices = 0;  // of the places that count
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
    std::size_t found = 0;
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const V3f at = (positions[v] - box.min) * steps + V3f(0.5f);
      const auto step = [](float x) { return static_cast<std::uint64_t>(static_cast<int>(x)); };
      const std::uint64_t hash = mixed(step(at.x) << 42 | step(at.y) << 21 | step(at.z));
      if (hash >> 32 & (part - 1)) continue;
      ++found;
      const std::uint64_t bit = hash & (64 * table.size() - 1);
      std::atomic_ref(table[bit / 64])
          .fetch_or(std::uint64_t{1} << bit % 64, std::memory_order_relaxed);
    }
    vertices += found;
  });
  if (vertices == 0) return 1;
  std::size_t taken = 0;
  for (const std::uint64_t word : table) taken += static_cast<std::size_t>(std::popcount(word));
  const auto all = static_cast<double>(64 * table.size());
  const double free = std::max(all - static_cast<double>(taken), 1.0);
  return -all * std::log(free / all) / static_cast<double>(vertices.load());
}

}  // namespace dapple
