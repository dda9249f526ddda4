// Vertices that meshes have in common, such as tiles of a floor side by side. In: a scene, and
// values at the vertices of its meshes. Out: the same values on both sides of a border.
#pragma once

#include "bake/two_sided.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Where vertices of several meshes, each placed once, lie at one place of the world
/// (welded_vertices()) with similar normals (group_vertices()), all get the mean over the meshes.
/// Meshes without values are left out. So do parts of a mesh of the file, which its mesh lights
/// divide, where all are placed alike. Linear in the vertices but for a sort of shared ones.
void join_borders(const Scene& scene, const TwoSided& two_sided, BakeResult& result);

}  // namespace dapple
