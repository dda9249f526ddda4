// How much rays have to do in an object, to tell when refitting has spoilt its BVH. In: the nodes
// of an object and the vertices of its mesh. Out: a number to compare with an earlier one.
#pragma once

#include <span>

#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

/// Expected visits of nodes (surface area heuristic; Goldsmith and Salmon, "Automatic Creation of
/// Object Hierarchies for Ray Tracing", 1987) of a ray through where most of `mesh` is. Not through
/// the root: if a single triangle lies far off, most rays through that meet nothing. From a part of
/// large objects. `nodes`: of the object.
double traversal_cost(std::span<const BvhNode> nodes, const Mesh& mesh);

}  // namespace dapple
