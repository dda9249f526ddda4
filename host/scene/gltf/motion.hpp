// Animations and skins: dapple shows the pose that nodes stand in, but a document whose
// indices lead nowhere is damaged, wherever they are.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace dapple::gltf {

/// In comes a document that keeps to the schema. Throws Error input when an animation, a skin
/// or a node's skin names what is not there.
void check_motion(const nlohmann::json& root, const std::string& file);

}  // namespace dapple::gltf
