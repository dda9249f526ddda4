// Makes instances from nodes with meshes: one per node, or many with EXT_mesh_gpu_instancing. Each
// instance of an emitting part becomes a mesh light. In: a document, its placed nodes and a pose;
// out: Scene::meshes, instances, lights and warnings.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/pose/hierarchy.hpp"

namespace dapple::gltf {

/// ROTATION of instance `i`, a unit quaternion; none (0,0,0,1) if it has no length.
Imath::V4d unit_rotation(const AccessorReader& rotations, std::uint64_t i);

/// Appends meshes (only those that a placed node uses), instances and mesh lights to the scene, and
/// a warning for each kind of thing that is left out. Throws Error input, also when the scene has
/// no instance.
void add_instances(const Document& document, const std::vector<PlacedNode>& placed,
                   const MaterialSet& materials, const Pose& pose, const SceneOptions& options,
                   Scene& scene);

}  // namespace dapple::gltf
