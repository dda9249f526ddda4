// Reads the cameras of placed nodes. In: a document and its placed nodes; out: Scene::cameras.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/hierarchy.hpp"

namespace dapple::gltf {

/// Appends cameras with rigid matrices to Scene::cameras. A camera whose node has a scale of zero
/// is left out, with a warning. Throws Error input for invalid angles, sizes and clip planes.
void add_cameras(const Document& document, const std::vector<PlacedNode>& placed, Scene& scene);

}  // namespace dapple::gltf
