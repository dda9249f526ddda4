// Baked values as attributes of a glTF file. In: what bake() returned, and the scene. Out:
// attributes of primitives.
#pragma once

#include <string>
#include <vector>

#include "commands/bake/bake_arguments.hpp"
#include "scene/gltf/edit/attribute_writer.hpp"
#include "scene/gltf/edit/source_file.hpp"

namespace dapple {

/// Where values go in the file.
struct BakeTargets {
  BakeChannel channel;                                ///< of AO
  bool multiply = true;                               ///< AO with a COLOR_0 that the file has
  std::string bent_channel;                           ///< "_BENT_NORMAL" or "NORMAL"
  BakePlacement placement = BakePlacement::together;  ///< of the values
};

/// Throws Error usage for a TEXCOORD_n that a primitive cannot have, because it lacks those before,
/// and for one that a texture uses.
void check_channel(const gltf::SourceFile& file, const Scene& scene, const BakeChannel& channel);

/// The attribute of a light of that name.
std::string light_attribute_name(const std::string& light);

/// Throws Error usage for the attribute of a light.
void check_channel_spares_lights(const BakeChannel& channel, const std::vector<Light>& lights);

/// AO, and bent normals and lights where they were baked; of these _LIGHT_ and their names.
std::vector<gltf::NewAttribute> baked_attributes(const gltf::SourceFile& file, const Scene& scene,
                                                 const BakeResult& result,
                                                 const BakeTargets& targets);

/// Whether baking multiplies components of a COLOR_0 that the file has.
bool multiplies_colors(const gltf::SourceFile& file, const Scene& scene, const BakeResult& result,
                       const BakeTargets& targets);

}  // namespace dapple
