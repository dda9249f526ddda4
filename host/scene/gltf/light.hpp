// Reads KHR_lights_punctual and gives a size to these lights, which have none. In: a document and
// its placed nodes; out: Scene::lights.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/hierarchy.hpp"

namespace dapple::gltf {

/// Appends the punctual lights of placed nodes to Scene::lights. A directional light becomes a sun
/// of the same irradiance; a point or spot light becomes a sphere of radius options.light_radius
/// (metres) with the same intensity. A light whose node has a scale of zero is left out, or
/// dark if the file has animations, with a warning; another one names a sphere that is large for
/// the scene's meshes, which are read before. Throws Error input.
void add_punctual_lights(const Document& document, const std::vector<PlacedNode>& placed,
                         const SceneOptions& options, Scene& scene);

}  // namespace dapple::gltf
