// Protocol "points": AO at fixed shading points, as for baking. In: points. Out: a reference, and
// contestants that compute AO with Embree and dapple.
#pragma once

#include "rivals/contest.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct PointQueries {
  std::size_t max_rays = 1024;            ///< a point, at the largest effort
  float footprint = kOcclusionFootprint;  ///< dapple's
};

/// Exact AO by Embree with multiplicative alpha, as two independent halves.
Truth point_truth(const RivalScene& scene, std::span<const Surface> points, std::size_t rays);

/// Embree's `methods`, and dapple's exact, prefiltered and packets, with 1, 2, 4... rays per point.
std::vector<Contestant> point_contestants(const RivalScene& scene, std::span<const Surface> points,
                                          const std::vector<EmbreeMethod>& methods,
                                          const PointQueries& queries);

}  // namespace dapple::bench
