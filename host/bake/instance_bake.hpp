// Bakes the mean ambient occlusion, or irradiance, of each instance of a scene. In: a scene, and
// functions that trace samples. Out: a value for each instance.
#pragma once

#include <optional>
#include <vector>

#include "bake/sample_rounds.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Samples of an instance whose mean is its value.
inline constexpr int kInstanceSamples = 16;

/// Rays of such a sample, at most.
inline constexpr int kInstanceRays = 192;

struct InstanceValues {
  std::vector<float> ao;                ///< [0,1]; 1 for strands and meshes without an area
  std::vector<std::vector<V3f>> light;  ///< irradiance by light and instance; 0 for such
};

/// Nothing if the bake is to stop.
std::optional<InstanceValues> bake_instances(const Scene& scene, const BakeOptions& options,
                                             BakeTracing& tracing);

}  // namespace dapple
