// How nodes show their meshes: uses that are equal share the mesh that was read.
#pragma once

#include <compare>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"
#include "scene/gltf/pose.hpp"

namespace dapple::gltf {

struct MeshUse {
  int mesh = 0;                 ///< glTF's index
  float line_radius = 0;        ///< of its lines, in its own units; 0: they are left out
  int skin = -1;                ///< that carries its vertices, -1 for none
  std::vector<double> weights;  ///< of its morph targets; empty where all are 0
  int node = -1;  ///< the one that uses it, where it changes with the time; else shared, -1

  auto operator<=>(const MeshUse&) const = default;
};

/// Of a placed node that has a mesh. A mesh that changes with the time belongs to its node, even
/// while two happen to be equal: what is shared must not depend on the time.
MeshUse use_of(const Document& document, const PlacedNode& placed, const Pose& pose,
               const SceneOptions& options);

}  // namespace dapple::gltf
