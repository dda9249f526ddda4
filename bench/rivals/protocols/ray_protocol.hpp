// Protocol "rays": occlusion rays per second, for rays that are prepared in memory. In: shading
// points. Out: speed and mean transmittance of each method of Embree and dapple.
#pragma once

#include "rivals/protocols/ray_rows.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

/// AO rays per shading point; their footprints depend on it.
inline constexpr std::size_t kRaysAPoint = 16;

/// The same rays for both programs.
struct PreparedRays {
  std::vector<std::unique_ptr<RayBatch>> batches;  ///< for Embree
  std::vector<Ray> rays;                           ///< for dapple, in the order of the batches
};

PreparedRays prepare_rays(std::span<const Surface> points, std::uint32_t seed);

/// Measures Embree's `methods` and, with `ours`, dapple's exact and prefiltered single rays and
/// packets: `repeats` interleaved rounds.
std::vector<RayRow> measure_rays(RivalScene& scene, const PreparedRays& rays,
                                 const std::vector<EmbreeMethod>& methods, bool ours, int repeats);

/// The fastest method of each alpha, stochastic first.
std::vector<EmbreeMethod> best_of_each_alpha(const std::vector<EmbreeMethod>& methods,
                                             const std::vector<double>& seconds);

/// The same, after measuring all methods with these rays.
std::vector<EmbreeMethod> calibrated_methods(RivalScene& scene, const PreparedRays& rays);

}  // namespace dapple::bench
