// Options of one of the independent sets of rays in which each quantity at a point is measured; the
// differences between sets give the standard error. In: options of all rays, the number of a set.
// Out: options of that set.
#pragma once

#include "dapple/points.hpp"

namespace dapple {

/// Independent sets of rays of each quantity.
inline constexpr int kPointSets = 8;

/// The rays of one set of AO.
inline OcclusionOptions rays_of_set(const PointOptions& options, int set) {
  OcclusionOptions of_set;
  of_set.rays = options.rays / kPointSets;
  of_set.estimator = options.estimator;
  of_set.footprint = options.footprint;
  // The bits that the product loses count, too.
  of_set.seed = (options.seed * kPointSets + static_cast<std::uint32_t>(set)) ^
                (options.seed >> 29) * 0x9e3779b8u;
  return of_set;
}

}  // namespace dapple
