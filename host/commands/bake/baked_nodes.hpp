// Baked values of instances as values of nodes of a glTF file. In: what bake() returned, and the
// scene. Out: values of nodes.
#pragma once

#include <string>
#include <vector>

#include "dapple/bake.hpp"
#include "scene/gltf/edit/attribute_writer.hpp"
#include "scene/gltf/edit/source_file.hpp"

namespace dapple {

/// Of each placement of a node the mean over the meshes that it shows: AO, and lights where they
/// were baked, as the instance attributes `attribute` and _LIGHT_NAME or the extras ao and
/// light_NAME. An attribute _COLOR_0 is AO as a grey colour.
std::vector<gltf::NodeValues> baked_nodes(const gltf::SourceFile& file, const Scene& scene,
                                          const BakeResult& result, const std::string& attribute);

}  // namespace dapple
