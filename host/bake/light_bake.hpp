// Irradiance of lights at the vertices of one mesh. In: a mesh, its placements and the scene on the
// device. Out: linear RGB for each light and vertex.
#pragma once

#include <optional>

#include "bake/bake_progress.hpp"
#include "bake/occluder_scene.hpp"
#include "bake/sample_tracer.hpp"

namespace dapple {

/// Samples of each triangle and side that lights are baked with.
inline constexpr std::uint32_t kLightSamples = 4;

/// For each light of `occluders` the irradiance at each vertex of `mesh`, number `index` of its
/// scene: weighted as AO is. Of two-sided triangles it is that of the side that all lights together
/// light more, or the mean with BakeSides::mean. Nothing if `progress` says that the bake is to
/// stop.
std::optional<std::vector<std::vector<V3f>>> bake_lights(
    const Mesh& mesh, const std::vector<bool>& two_sided, std::uint32_t index,
    const Placements& placements, const BakeOptions& options, const OccluderScene& occluders,
    BakeProgress& progress);

}  // namespace dapple
