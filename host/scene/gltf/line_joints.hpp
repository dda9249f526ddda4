// Joins lines whose file has vertices of its own for each segment, as exporters write them. In: a
// mesh and where its last primitive begins. Out: the mesh, whose segments share vertices.
#pragma once

#include <cstddef>

#include "dapple/scene.hpp"

namespace dapple::gltf {

/// Where exactly two ends of segments meet in one point, each at a vertex of its own with the same
/// colour and opacity, they become one vertex: a strand goes on there, and has no end. Of vertices
/// from `first_vertex` on and indices from `first_index` on.
void join_lines(Mesh& mesh, std::size_t first_vertex, std::size_t first_index);

}  // namespace dapple::gltf
