// Gives every placement of a mesh a mesh of its own, so that each can have values of its own. In
// and out: a file and its scene.
#pragma once

#include "dapple/scene.hpp"
#include "scene/gltf/edit/source_file.hpp"

namespace dapple {

/// Copies meshes that are shown several times, in the file and in the scene. Instances of
/// EXT_mesh_gpu_instancing, which share one mesh, become nodes.
void make_meshes_unique(gltf::SourceFile& file, Scene& scene);

}  // namespace dapple
