// Protocol "points": AO at fixed shading points, which is what baking needs.
#pragma once

#include "rivals/contest.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct PointOptions {
  std::size_t max_rays = 1024;        ///< a point: the ladder's end
  std::size_t reference_rays = 4096;  ///< a point
};

/// Exact AO by multiplying, in two halves; not cached, as it takes seconds.
Truth point_truth(const RivalScene& scene, std::span<const Surface> points, std::size_t rays);

/// Embree's `methods` and dapple's exact, prefiltered and packet, at 1, 2, 4... rays a point.
std::vector<Contestant> point_contestants(const RivalScene& scene, std::span<const Surface> points,
                                          const std::vector<EmbreeMethod>& methods,
                                          std::size_t max_rays);

}  // namespace dapple::bench
