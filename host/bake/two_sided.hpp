// Which triangles of a mesh are baked on both sides. In: a scene and BakeSides. Out: a flag for
// each triangle.
#pragma once

#include <vector>

#include "dapple/bake.hpp"

namespace dapple {

/// Whether the values of each triangle of `mesh`, which is one of the scene's, describe both sides.
/// With BakeSides::automatic those of double-sided materials in small sheets, such as leaves and
/// cards. Grounds, walls and pots have a side that is meant to be seen, though programs write their
/// materials as double-sided: the front.
std::vector<bool> two_sided_triangles(const Scene& scene, const Mesh& mesh, BakeSides sides);

}  // namespace dapple
