// The mean ambient occlusion of each instance of a scene. In: a scene and a tracer. Out: a value
// for each instance.
#pragma once

#include <optional>
#include <vector>

#include "bake/bake_progress.hpp"
#include "bake/sample_tracer.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Samples of an instance whose mean is its value.
inline constexpr int kInstanceSamples = 16;

/// Rays of such a sample, at most.
inline constexpr int kInstanceRays = 192;

/// AO of each instance, [0,1]; 1 for strands and meshes without an area. Nothing if `progress` says
/// that the bake is to stop.
std::optional<std::vector<float>> bake_instances(const Scene& scene, const BakeOptions& options,
                                                 SampleTracer& tracer, BakeProgress& progress);

}  // namespace dapple
