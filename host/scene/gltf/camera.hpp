// Cameras of placed nodes.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"

namespace dapple::gltf {

/// Appends to Scene::cameras, with rigid matrices. Throws Error input for angles and
/// sizes that no camera can have.
void add_cameras(const Document& document, const std::vector<PlacedNode>& placed, Scene& scene);

}  // namespace dapple::gltf
