// In which placements the meshes of a scene are baked. In: a scene. Out: matrices by mesh.
#pragma once

#include <vector>

#include "bake/samples/sample_tracer.hpp"

namespace dapple {

/// The identity.
Placements placed_alone();

/// By mesh, those of its instances whose matrices can be inverted: what is scaled to zero is not in
/// the scene. Of meshes alone: the identity.
std::vector<Placements> placements_by_mesh(const Scene& scene, BakePlacement kind);

/// The number of placements_by_mesh() of each mesh.
std::vector<std::size_t> placement_counts(const Scene& scene, BakePlacement kind);

/// The number of meshes of triangles that have instances, but none that can be inverted.
std::size_t count_vanished_meshes(const Scene& scene);

}  // namespace dapple
