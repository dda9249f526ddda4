// Values of vertices that lie inside closed geometry, from those of their neighbours. In: a mesh
// and values of its vertex groups. Out: all values known, but in parts of the mesh that are hidden
// as a whole.
#pragma once

#include <vector>

#include "bake/value_sums.hpp"

namespace dapple {

void spread_to_hidden(const Mesh& mesh, const VertexGroups& groups,
                      std::vector<PlaceValue>& values);

}  // namespace dapple
