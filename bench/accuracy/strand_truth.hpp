// Reference transmittance of segments of strands. In: the segments of a part of a BVH. Out: their
// transmittance along rays in double precision, as dapple/shared/segment_block.h defines it.
// Embree's curves cannot do this: the part cuts strands off without caps.
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
