// The node tree of the scene to be shown, flattened: every node with its world matrix.
#pragma once

#include <Imath/ImathMatrix.h>

#include <vector>

#include "scene/gltf/document.hpp"
#include "scene/gltf/pose.hpp"

namespace dapple::gltf {

struct PlacedNode {
  int node;
  Imath::M44d to_world;  ///< row vectors: p_world = p * to_world
};

/// The nodes of the default scene (or of the first; or all, where there is no scene) in
/// depth-first file order. Throws Error input for cycles, nodes with two parents, trees
/// deeper than 1,024 and matrices that are not affine.
std::vector<PlacedNode> place_nodes(const Document& document, const Pose& pose = {});

/// The world matrix of every node, in whatever scene it is; as place_nodes() otherwise.
std::vector<Imath::M44d> world_matrices(const Document& document, const Pose& pose = {});

/// scale, then rotate by the unit quaternion x, y, z, w, then translate.
Imath::M44d compose(const Imath::V3d& translation, const Imath::V4d& rotation,
                    const Imath::V3d& scale);

}  // namespace dapple::gltf
