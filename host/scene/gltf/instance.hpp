// Placements: nodes with meshes become instances, once or, with EXT_mesh_gpu_instancing,
// many times; each placement of an emitting part becomes a mesh light.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"
#include "scene/gltf/material.hpp"

namespace dapple::gltf {

/// Fills Scene::meshes (only those that a placed node shows), instances and mesh lights,
/// at a pose, and warns of features left out. Throws Error input, also when there is nothing to
/// show.
void add_instances(const Document& document, const std::vector<PlacedNode>& placed,
                   const MaterialSet& materials, const Pose& pose, const SceneOptions& options,
                   Scene& scene);

}  // namespace dapple::gltf
