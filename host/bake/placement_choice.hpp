// Which placement of its mesh a sample is traced in. In: the number of the sample, and random bits
// of its triangle. Out: the number of a placement.
#pragma once

#include <cstdint>

namespace dapple {

/// Each `placements` samples in turn take all placements, in a random order: how often placements
/// are taken differs by one at most, and where a sample lies in its triangle says nothing about its
/// placement.
std::uint32_t placement_of_sample(std::uint32_t sample, std::uint32_t placements,
                                  std::uint32_t random);

}  // namespace dapple
