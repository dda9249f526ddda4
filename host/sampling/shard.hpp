// The samples of a shard: a range of the camera rays of every pixel. In: options. Out: the range.
// Ranges are cut at whole numbers of rays, so that shards of different counts fit together: 1/2,
// 3/4 and 4/4 are one picture.
#pragma once

#include <cstdint>

#include "dapple/options.hpp"

namespace dapple {

/// Camera rays of a pixel, [first, end).
struct RayRange {
  std::uint32_t first = 0, end = 0;
  bool operator==(const RayRange&) const = default;
};

inline RayRange rays_of(const Shard& shard, int spp) {
  const auto until = [&](int parts) {
    return static_cast<std::uint32_t>(std::int64_t{spp} * parts / shard.count);
  };
  return {until(shard.index - 1), until(shard.index)};
}

}  // namespace dapple
