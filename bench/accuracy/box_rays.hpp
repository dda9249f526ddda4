// Random rays through a box, uniform over its projection along a direction. In: a box, a direction
// and the contents of the box. Out: rays and their mean opacity.
#pragma once

#include <functional>
#include <vector>

#include "accuracy/subtree.hpp"
#include "oracle/embree_oracle.hpp"

namespace dapple::bench {

/// A ray through a box along a unit direction. `chord`: length inside the box, divided by the mean
/// length of such rays, which is volume / projected area. `middle`: of the chord, from the box's
/// centre, in half sizes of the box.
struct BoxRay {
  oracle::Segment segment;
  float chord;
  V3f middle;
};

/// Projected areas of the box's faces along `direction`, axis by axis, square metres.
V3f facing_areas(const V3f& size, const V3f& direction);

/// A ray uniform over the box's projection along `direction`.
BoxRay ray_through(const Box3f& box, const V3f& direction, oracle::Random& random);

/// Transmittance of the contents of a box along a ray.
using Truth = std::function<double(const oracle::Segment&)>;

/// Rays of one direction and the mean of their opacities.
struct SampledOpacity {
  std::vector<BoxRay> rays;
  double opacity;
  double variance;  ///< of `opacity`, estimated from the variance of the rays
};

SampledOpacity sample_opacity(const Truth& subtree, const Box3f& box, const V3f& direction,
                              int rays, oracle::Random& random);

}  // namespace dapple::bench
