// Encodes segments of strands as blocks of 16-bit steps and 8-bit codes, and decodes them.
#pragma once

#include <span>

#include "bvh/storage/strand_segment.hpp"
#include "dapple/shared/segment_block.h"

namespace dapple {

/// Packs up to eight segments. Codes are rounded to the nearest, so that errors average out. Errors
/// are at most 1/65535 of the block's largest side for end points, and 1/255 of the block's maximum
/// for radii and opacities, less for small ones: codes are their square roots. The maximum itself
/// is exact.
SegmentBlock pack_segments(std::span<const StrandSegment> segments);

/// Decodes a lane as kernels do.
StrandSegment unpack_segment(const SegmentBlock& block, unsigned lane);

}  // namespace dapple
