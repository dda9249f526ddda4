// What moves of a document, at one time: nodes that stand elsewhere than they are written to, and
// meshes that are morphed otherwise.
#pragma once

#include <Imath/ImathVec.h>

#include <map>
#include <optional>
#include <vector>

namespace dapple::gltf {

/// In place of a node's own properties.
struct NodePose {
  std::optional<Imath::V3d> translation;
  std::optional<Imath::V4d> rotation;  ///< unit quaternion x, y, z, w
  std::optional<Imath::V3d> scale;
  std::optional<std::vector<double>> weights;  ///< of morph targets

  [[nodiscard]] bool moves() const { return translation || rotation || scale; }
};

/// By node; empty: the document at rest.
using Pose = std::map<int, NodePose>;

}  // namespace dapple::gltf
