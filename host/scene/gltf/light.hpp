// KHR_lights_punctual: lights without size, given one.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"

namespace dapple::gltf {

/// Appends the punctual lights of placed nodes to Scene::lights. Directional ones become
/// suns of the same irradiance; point and spot ones spheres of options.light_radius with
/// the same intensity. Throws Error input.
void add_punctual_lights(const Document& document, const std::vector<PlacedNode>& placed,
                         const SceneOptions& options, Scene& scene);

}  // namespace dapple::gltf
