// Checks which glTF extensions a file requires. In: their names; out: an error for one that dapple
// can neither read nor ignore.
#include <algorithm>
#include <array>
#include <string_view>

#include "scene/gltf/document/document.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// Extensions that dapple reads, as far as they affect occlusion and light.
constexpr std::array<std::string_view, 9> kRead = {
    extension::kInstancing,
    extension::kLights,
    extension::kEmissiveStrength,
    extension::kSpecularGlossiness,
    extension::kQuantization,
    extension::kTextureTransform,
    extension::kMeshopt,
    extension::kWebp,
    extension::kDraco,
};

/// Extensions that dapple ignores: they change colour, gloss or metadata, but not opacity.
/// Transmission and volume are among them: glass occludes according to its alpha, because refracted
/// light does not continue in the direction of the shadow ray.
constexpr std::array<std::string_view, 15> kIgnored = {
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    extension::kUnlit,
    extension::kVariants,
    "KHR_materials_volume",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_animation_pointer",
};

bool is_supported(std::string_view name) {
  return std::find(kRead.begin(), kRead.end(), name) != kRead.end() ||
         std::find(kIgnored.begin(), kIgnored.end(), name) != kIgnored.end();
}

}  // namespace

void check_extensions(const std::vector<std::string>& required, const std::string& file) {
  for (const std::string& name : required) {
    if (is_supported(name)) continue;
    fail(file, "requires the extension {}, which dapple cannot read; export without it", name);
  }
}

}  // namespace dapple::gltf
