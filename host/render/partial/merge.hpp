// Adds up parts of a picture: shards of its samples and crops of its pixels, from any number of
// machines. In: their files. Out: the film that one render would have made, bit for bit, and what
// is missing. Keeps one part in memory beside the sum, however many there are.
#pragma once

#include <string>
#include <vector>

#include "dapple/render.hpp"

namespace dapple {

struct Merge {
  RenderResult result;  ///< with notes, and the statistics that the sums tell
  std::string missing;  ///< what the picture lacks, in words; empty: nothing
  std::uint32_t spp = 0;
};

/// Adds up the parts `paths`, in any order. With `output` also writes the sum as a part, which may
/// be merged again, or resumed. Throws Error failed for damaged files; Error usage, which names the
/// files and what differs, for parts of different pictures, parts that overlap or are not finished,
/// and parts with a target error.
Merge merge_parts(const std::vector<std::string>& paths, const std::string& output = "");

}  // namespace dapple
