// Transmittance of strands, by the definition in dapple/shared/segment_block.h and in double, for
// the segments of a part of a BVH: cut off where the part ends, they are no strands to Embree.
#pragma once

#include <memory>
#include <vector>

#include "bvh/storage/strand_segment.hpp"
#include "oracle/embree_oracle.hpp"

namespace dapple::bench {

class StrandTruth {
 public:
  explicit StrandTruth(std::vector<StrandSegment> segments);
  ~StrandTruth();

  /// Product of (1 - opacity) over the segments that `ray` enters.
  [[nodiscard]] double transmittance(const oracle::Segment& ray) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace dapple::bench
