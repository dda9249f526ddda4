// Protocol "rays": occlusion rays a second, on rays that lie ready in memory.
#pragma once

#include "rivals/rival_scene.hpp"

namespace dapple::bench {

/// AO rays of a shading point, which also sets their footprints.
inline constexpr std::size_t kRaysAPoint = 16;

/// Rays of one set of points, the same for both sides.
struct PreparedRays {
  std::vector<std::unique_ptr<RayBatch>> batches;  ///< for Embree
  std::vector<Ray> rays;                           ///< for dapple; batch after batch
};

PreparedRays prepare_rays(std::span<const Surface> points, std::uint32_t seed);

struct RayRow {
  std::string name;
  bool is_embree = false;
  double rays_a_second = 0;       ///< median; of dapple by the device's clock, copies left out
  double fastest_seconds = 0;     ///< of all rounds
  double spread = 0;              ///< (largest - smallest) / median of the seconds
  double mean_transmittance = 0;  ///< over all rays
  double visits = 0, tests = 0;   ///< a ray; dapple's only
};

/// Embree's `methods` and, where `ours`, dapple's exact and prefiltered single rays and packets,
/// `repeats` times in turn.
std::vector<RayRow> measure_rays(RivalScene& scene, const PreparedRays& rays,
                                 const std::vector<EmbreeMethod>& methods, bool ours, int repeats);

/// The fastest method of each alpha, stochastic first.
std::vector<EmbreeMethod> best_of_each_alpha(const std::vector<EmbreeMethod>& methods,
                                             const std::vector<double>& seconds);

/// The same by measuring all methods on the rays.
std::vector<EmbreeMethod> calibrated_methods(RivalScene& scene, const PreparedRays& rays);

}  // namespace dapple::bench
