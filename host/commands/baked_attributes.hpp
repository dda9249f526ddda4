// Baked values as attributes of a glTF file. In: what bake() returned, and the scene. Out:
// attributes of primitives and values of nodes.
#pragma once

#include <vector>

#include "commands/bake_arguments.hpp"
#include "scene/gltf/attribute_writer.hpp"
#include "scene/gltf/source_file.hpp"

namespace dapple {

/// AO in `channel`, and _BENT_NORMAL where bent normals were baked. With `multiply`, AO is
/// multiplied with a COLOR_0 that the file has.
std::vector<gltf::NewAttribute> baked_attributes(const gltf::SourceFile& file, const Scene& scene,
                                                 const std::vector<BakedMesh>& meshes,
                                                 const BakeChannel& channel, bool multiply);

/// The mean AO of the meshes that each placement of a node shows.
std::vector<gltf::NodeValues> baked_nodes(const Scene& scene, const std::vector<float>& ao);

}  // namespace dapple
