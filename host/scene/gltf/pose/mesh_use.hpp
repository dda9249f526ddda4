// How a node uses its mesh: line radius, skin, morph weights. In: a placed node and a pose; out: a
// MeshUse. Nodes with equal uses share one dapple mesh.
#pragma once

#include <compare>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/hierarchy.hpp"
#include "scene/gltf/pose/pose.hpp"

namespace dapple::gltf {

struct MeshUse {
  int mesh = 0;                 ///< glTF's index
  float line_radius = 0;        ///< of its lines, in the mesh's units; 0: lines are left out
  int skin = -1;                ///< the skin of its vertices, -1 for none
  bool mirrored = false;        ///< skinned, and its node turns the winding of its triangles
  std::vector<double> weights;  ///< of its morph targets; empty when all are 0
  bool colors = false;          ///< SceneOptions::colors
  int node = -1;  ///< the node that uses it, if it changes with time; -1: can be shared

  auto operator<=>(const MeshUse&) const = default;
};

/// Returns the use of a placed node that has a mesh. A mesh that changes with time is never shared,
/// even while two uses are equal, so that sharing does not depend on the time.
MeshUse use_of(const Document& document, const PlacedNode& placed, const Pose& pose,
               const SceneOptions& options);

}  // namespace dapple::gltf
