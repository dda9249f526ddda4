// Extends the values of a texture over the texels beside them, so that lookups across a chart's
// border find no empty texel. In: which texels have a value. Out: the one that each takes.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// For each texel of a `size` x `size` texture the nearest valid one, itself if it is valid, at
/// most `margin` texels away in each direction; kNoTexel without one. The distance is Euclidean, to
/// the accuracy of a search from neighbour to neighbour (Danielsson, "Euclidean Distance Mapping",
/// 1980). `within`: texels that the search passes through, by texel; empty: all.
std::vector<std::uint32_t> nearest_valid(const std::vector<bool>& valid, std::uint32_t size,
                                         int margin, const std::vector<bool>& within = {});

inline constexpr std::uint32_t kNoTexel = ~0u;

}  // namespace dapple
