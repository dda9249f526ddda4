// Vertices that lie inside closed geometry, and the neighbours whose values they take. In: a mesh
// and which of its vertex groups are known. Out: for each enclosed group the groups whose mean it
// takes, in an order in which these are known.
#pragma once

#include <vector>

#include "bake/vertex_groups.hpp"

namespace dapple {

/// The mean of `sources` is the value of `group`. A neighbour counts once for each shared edge.
struct EnclosedGroup {
  std::uint32_t group = 0;
  std::vector<std::uint32_t> sources;
};

/// Breadth first over the triangles' edges. Parts of the mesh that are enclosed as a whole are not
/// in the list: they keep their values.
std::vector<EnclosedGroup> enclosed_groups(const Mesh& mesh, const VertexGroups& groups,
                                           std::vector<bool> known);

}  // namespace dapple
