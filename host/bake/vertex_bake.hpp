// Bakes the vertices of one mesh in rounds: it takes a sample of each triangle, then more where the
// values are uncertain. In: a mesh, its placements, and functions that trace samples. Out: AO, bent
// normals and irradiance at vertices.
#pragma once

#include <optional>

#include "bake/samples/sample_rounds.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// The small parts that the vertex groups of a mesh belong to.
SmallParts small_parts(const Mesh& mesh, const VertexGroups& groups);

/// The values of the vertices of `mesh`, which is number `index` of its scene; nothing if
/// `progress` says that the bake is to stop.
std::optional<BakedMesh> bake_mesh(const Mesh& mesh, const std::vector<bool>& two_sided,
                                   std::uint32_t index, const Placements& placements,
                                   const BakeOptions& options, BakeTracing& tracing);

/// `first` samples of each element, then as many as the options say for so many placements; of
/// lights if `lights`.
RoundOptions round_options(const BakeOptions& options, std::uint32_t first,
                           const Placements& placements, bool lights);

}  // namespace dapple
