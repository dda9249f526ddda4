// Encodes segments of strands as blocks of 16-bit steps and 8-bit codes, and decodes them.
#pragma once

#include <span>

#include "bvh/storage/strand_segment.hpp"
#include "dapple/shared/segment_block.h"

namespace dapple {

/// Up to eight segments. Codes are rounded to the nearest, so that what is wrong at one is made
/// good at others: end points to 1/65535 of the block's largest side, radii and opacities to 1/510
/// of the block's greatest, which itself is kept as it is.
SegmentBlock pack_segments(std::span<const StrandSegment> segments);

/// Decodes a lane as kernels do.
StrandSegment unpack_segment(const SegmentBlock& block, unsigned lane);

}  // namespace dapple
