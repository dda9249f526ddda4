// Rays spread evenly over what a box shows of itself along a direction, and how opaque a
// subtree is to them.
#pragma once

#include <functional>
#include <vector>

#include "accuracy/subtree.hpp"
#include "oracle/embree_oracle.hpp"

namespace dapple::bench {

/// Through a box along a unit direction; `chord` is the length inside the box over the mean
/// length of all such rays, volume / projected area; `off_centre` is the squared distance of the
/// middle of its way inside from the box's centre, in half sizes.
struct BoxRay {
  oracle::Segment segment;
  float chord;
  float off_centre;
};

/// Projected areas of the box's faces along `direction`, axis by axis, square metres.
V3f facing_areas(const V3f& size, const V3f& direction);

/// A ray uniform over the box's projection along `direction`.
BoxRay ray_through(const Box3f& box, const V3f& direction, oracle::Random& random);

/// Rays of one direction and the mean opacity they met.
/// Transmittance of what a box holds along a ray.
using Truth = std::function<double(const oracle::Segment&)>;

struct SampledOpacity {
  std::vector<BoxRay> rays;
  double opacity;
  double variance;  ///< of `opacity`, estimated from the rays' spread
};

SampledOpacity sample_opacity(const Truth& subtree, const Box3f& box, const V3f& direction,
                              int rays, oracle::Random& random);

}  // namespace dapple::bench
