// Bakes the mean ambient occlusion, or irradiance, of each instance of a scene. In: a scene, and
// functions that trace samples. Out: a value for each instance.
#pragma once

#include <optional>
#include <vector>

#include "bake/samples/sample_rounds.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Samples of an instance that are traced before its error is looked at, and then at a time.
inline constexpr std::uint32_t kInstanceRound = 32;

/// Rounds that a target needs in the mean, for the first guess of the time left.
inline constexpr std::uint32_t kExpectedRounds = 2;

struct InstanceValues {
  std::vector<float> ao;                ///< [0,1]; 1 for strands and meshes without an area
  std::vector<std::vector<V3f>> light;  ///< irradiance by light and instance; 0 for such
};

/// Samples are spread over the area of a mesh, in rounds: until the standard error of a value is
/// options.target_error, at most options.rays / kRaysPerSample of them; without a target as many.
/// Nothing if the bake is to stop.
std::optional<InstanceValues> bake_instances(const Scene& scene, const BakeOptions& options,
                                             BakeTracing& tracing);

}  // namespace dapple
