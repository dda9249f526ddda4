// Flattens the node tree of the scene to be shown. In: a document and a pose; out: a list of nodes
// with their world matrices.
#pragma once

#include <Imath/ImathMatrix.h>

#include <vector>

#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/pose.hpp"

namespace dapple::gltf {

struct PlacedNode {
  int node;
  Imath::M44d to_world;  ///< row vectors: p_world = p * to_world
};

/// Returns the nodes of the default scene, or of the first scene, or all nodes when the document
/// has no scene, depth first in the file's order. Throws Error input for cycles, nodes with two
/// parents, trees deeper than 65,536, and matrices that are not affine or not finite.
std::vector<PlacedNode> place_nodes(const Document& document, const Pose& pose = {});

/// Returns the world matrix of every node, also of nodes outside of the shown scene. Throws like
/// place_nodes(), but does not check for cycles.
std::vector<Imath::M44d> world_matrices(const Document& document, const Pose& pose = {});

/// Returns the matrix that scales, then rotates by the unit quaternion x, y, z, w, then translates.
Imath::M44d compose(const Imath::V3d& translation, const Imath::V4d& rotation,
                    const Imath::V3d& scale);

}  // namespace dapple::gltf
