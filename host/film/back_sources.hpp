// Stands in for pixels that have samples but none of their backs, as where samples of other shards
// are missing. In: the numbers of back samples. Out: pixels whose sums are to be used.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace dapple {

/// Returns for each pixel of an image of `width` the pixel whose back samples stand for its own:
/// itself if `has_backs`, or the nearest one that has, at most 16 pixels away; else itself.
std::vector<std::uint32_t> back_sources(std::uint32_t pixels, std::uint32_t width,
                                        const std::function<bool(std::uint32_t)>& has_backs);

}  // namespace dapple
