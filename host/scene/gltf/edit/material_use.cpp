#include "scene/gltf/edit/material_use.hpp"

#include "scene/gltf/document/extension_names.hpp"

namespace dapple::gltf {
namespace {

bool names_set(const Json& object, std::uint32_t set) {
  return object.contains("texCoord") && object["texCoord"].is_number_unsigned() &&
         object["texCoord"].get<std::uint64_t>() == set;
}

/// KHR_texture_transform may name another set, for viewers that know it.
bool uses_set(const Json& texture_info, std::uint32_t set) {
  if (names_set(texture_info, set) || (set == 0 && !texture_info.contains("texCoord"))) return true;
  return has_extension(texture_info, extension::kTextureTransform) &&
         names_set(texture_info["extensions"][extension::kTextureTransform], set);
}

}  // namespace

std::string texture_with_uvs(const Json& material, std::uint32_t set) {
  for (const auto& [key, value] : material.items()) {
    if (!value.is_structured() || key == "extras") continue;
    if (value.contains("index")) {
      if (uses_set(value, set)) return key;
    } else if (std::string inside = texture_with_uvs(value, set); !inside.empty()) {
      return inside;
    }
  }
  return {};
}

}  // namespace dapple::gltf
