// Stands in for pixels that have samples but none of their backs, as where samples of other shards
// are missing. In: the numbers of back samples. Out: pixels whose sums are to be used.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace dapple {

/// Which pixels of an image have samples of their backs, and which need those of others.
using PixelTest = std::function<bool(std::uint32_t)>;

/// Returns for each of `pixels` of an image of `width` the pixel whose back samples stand for its
/// own: where it `needs` others, the nearest one that `has` some, at most 16 pixels away; else
/// itself.
std::vector<std::uint32_t> back_sources(std::uint32_t pixels, std::uint32_t width,
                                        const PixelTest& needs, const PixelTest& has);

}  // namespace dapple
