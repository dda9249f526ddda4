// Rays from points into zenith rings. In: a point and a ring. Out: rays, or gap fractions.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/ray.h"
#include "points/scene_of_points.hpp"

namespace dapple {

/// Directions between two cosines of the angle from +Y.
struct ZenithRing {
  double cos_inner = 1, cos_outer = 0;
};

/// `count` rings: for 5 those of the LAI-2200, else of equal width from 0 to 90 degrees.
std::vector<ZenithRing> zenith_rings(int count);

/// Fills `rays`, uniform by solid angle within a ring: a Vogel spiral, turned by random bits. They
/// start off the point along `normal`.
void fill_ring_rays(const V3f& point, const V3f& normal, const ZenithRing& ring,
                    std::uint32_t random, std::span<Ray> rays);

/// Gap fractions of one set of `of_ring` rays for each ring, [point * rings + ring]. step(part of
/// the points) after each slice returns false to stop.
std::vector<double> gap_fractions(const SceneOfPoints& on, const std::vector<ZenithRing>& rings,
                                  std::span<const V3f> points, std::span<const V3f> normals,
                                  const OcclusionOptions& of_ring,
                                  const std::function<bool(double)>& step);

}  // namespace dapple
