// The pose of a document at one time: values that replace the transforms and morph weights of its
// nodes. animation.hpp makes it, hierarchy.hpp and mesh_use.hpp use it.
#pragma once

#include <Imath/ImathVec.h>

#include <map>
#include <optional>
#include <vector>

namespace dapple::gltf {

/// Replaces properties of one node; an empty one keeps the file's value.
struct NodePose {
  std::optional<Imath::V3d> translation;
  std::optional<Imath::V4d> rotation;  ///< unit quaternion x, y, z, w
  std::optional<Imath::V3d> scale;
  std::optional<std::vector<double>> weights;  ///< of morph targets

  [[nodiscard]] bool moves() const { return translation || rotation || scale; }
};

/// The poses by node index; an empty map is the document at rest.
using Pose = std::map<int, NodePose>;

}  // namespace dapple::gltf
