// A round of work, slice by slice: groups of pixels that were given samples together, and how far
// they are traced. What is decided between rounds needs all of one; renders stop between slices.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/shared/pass_params.h"

namespace dapple {

/// Pixels that get the same number of samples.
struct WorkGroup {
  std::uint32_t samples = 0;
  std::vector<PixelWork> work;  ///< tile by tile: neighbours in the list are so in the picture
};

struct Round {
  std::vector<WorkGroup> groups;  ///< to be traced in this order
  std::uint32_t group = 0;        ///< where the next slice begins: group, entry of its work, and
  std::uint32_t entry = 0;        ///< sample, counted from the entry's own first
  std::uint32_t sample = 0;

  [[nodiscard]] bool is_done() const { return group >= groups.size(); }
};

/// The next slice of a round that is not done, of at most `slice_samples` (a batch or more) in all.
/// What is cut depends on nothing else, so that a render can go on elsewhere.
SliceParams next_slice(const Round& round, std::uint32_t slice_samples);

/// Moves past next_slice().
void advance(Round& round, std::uint32_t slice_samples);

/// Samples of each pixel that are traced, where `given` counts the whole round's too. Throws Error
/// failed where the two don't fit together.
std::vector<std::uint32_t> traced_samples(const Round& round, std::uint32_t slice_samples,
                                          const std::vector<std::uint32_t>& given);

}  // namespace dapple
