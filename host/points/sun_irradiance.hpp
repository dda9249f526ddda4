// The part of the light of many suns that reaches points. In: suns, points with normals, the number
// of sets of rays. Out: a value in [0,1] for each set and point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "points/scene_of_points.hpp"
#include "points/sun_rays.hpp"

namespace dapple {

/// Whether the rays of a point are shared among all suns, for their sum.
inline bool is_sampled(const PointOptions& options) {
  return !options.per_sun && !options.suns.empty();
}

/// Irradiance over that without occlusion, [set][point], 1 where no sun shines. A set has
/// options.rays / kPointSets rays. step(part of the points) after each slice returns false to stop.
std::vector<std::vector<double>> sun_parts(const SceneOfPoints& on, const SunRays& suns,
                                           std::span<const V3f> points,
                                           std::span<const V3f> normals,
                                           const PointOptions& options, std::size_t sets,
                                           std::uint32_t seed,
                                           const std::function<bool(double)>& step);

}  // namespace dapple
