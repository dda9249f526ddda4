// Reads materials: see material.hpp.
#include "scene/gltf/material.hpp"

#include <algorithm>
#include <cmath>

#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/texture.hpp"
#include "scene/gltf/topology.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using tinygltf::Value;

/// A baseColorTexture, or the diffuseTexture that replaces it; tinygltf has a different type for
/// each of them.
struct TextureUse {
  int texture = -1;
  int texcoord = 0;
  const Value* transform = nullptr;  ///< KHR_texture_transform's object
};

struct BaseColor {
  std::vector<double> factor{1, 1, 1, 1};
  TextureUse texture;
};

const Value* find(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

const Value* find(const Value* object, const char* key) {
  return object != nullptr && object->Has(key) ? &object->Get(key) : nullptr;
}

double number_or(const Value* value, double otherwise) {
  return value != nullptr ? value->GetNumberAsDouble() : otherwise;
}

V2f vec2_or(const Value* value, V2f otherwise) {
  if (value == nullptr || value->ArrayLen() != 2) return otherwise;
  return {static_cast<float>(value->Get(0).GetNumberAsDouble()),
          static_cast<float>(value->Get(1).GetNumberAsDouble())};
}

TextureUse metallic_roughness_texture(const tinygltf::TextureInfo& info) {
  return {info.index, info.texCoord, find(info.extensions, extension::kTextureTransform)};
}

TextureUse diffuse_texture(const Value* info) {
  if (info == nullptr) return {};
  const Value* texcoord = find(info, "texCoord");
  return {info->Get("index").GetNumberAsInt(), texcoord != nullptr ? texcoord->GetNumberAsInt() : 0,
          find(find(info, "extensions"), extension::kTextureTransform)};
}

/// KHR_materials_pbrSpecularGlossiness, if present, replaces all of pbrMetallicRoughness.
BaseColor base_color(const tinygltf::Material& material) {
  BaseColor base;
  const Value* gloss = find(material.extensions, extension::kSpecularGlossiness);
  if (gloss == nullptr) {
    const auto& pbr = material.pbrMetallicRoughness;
    base.factor = pbr.baseColorFactor;
    base.texture = metallic_roughness_texture(pbr.baseColorTexture);
    return base;
  }
  if (const Value* factor = find(gloss, "diffuseFactor"); factor != nullptr) {
    for (std::size_t i = 0; i < 4; ++i)
      base.factor[i] = factor->Get(static_cast<int>(i)).GetNumberAsDouble();
  }
  base.texture = diffuse_texture(find(gloss, "diffuseTexture"));
  return base;
}

/// Reads KHR_texture_transform: scale, then rotation, then offset. The sign of the rotation is that
/// of the extension's text ("counter-clockwise", where v points down), of its example and of other
/// implementations; its GLSL code rotates the other way (KhronosGroup/glTF issue 1563).
AlphaLookup alpha_lookup(const TextureUse& use) {
  AlphaLookup lookup;
  lookup.has_texture = use.texture >= 0;
  lookup.texcoord = use.texcoord;
  if (use.transform == nullptr) return lookup;
  if (const Value* texcoord = find(use.transform, "texCoord"); texcoord != nullptr) {
    lookup.texcoord = texcoord->GetNumberAsInt();
  }
  const V2f scale = vec2_or(find(use.transform, "scale"), V2f(1, 1));
  const double angle = number_or(find(use.transform, "rotation"), 0.0);
  const auto cosine = static_cast<float>(std::cos(angle));
  const auto sine = static_cast<float>(std::sin(angle));
  lookup.du = V2f(cosine, -sine) * scale.x;
  lookup.dv = V2f(sine, cosine) * scale.y;
  lookup.offset = vec2_or(find(use.transform, "offset"), V2f(0, 0));
  return lookup;
}

AlphaMode alpha_mode(const tinygltf::Material& material) {
  if (material.alphaMode == "MASK") return AlphaMode::mask;
  return material.alphaMode == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

V3f emission_factor(const tinygltf::Material& material) {
  const double strength = number_or(
      find(find(material.extensions, extension::kEmissiveStrength), "emissiveStrength"), 1.0);
  V3f emission;
  for (int channel = 0; channel < 3; ++channel) {
    const double value = material.emissiveFactor[static_cast<std::size_t>(channel)] * strength;
    emission[channel] = static_cast<float>(std::clamp(value, 0.0, 1e30));
  }
  return emission;
}

/// A mesh light has one radiance, so it uses the mean of an emissive texture. When the image cannot
/// be read, the light keeps the factor's colour, with a warning.
void apply_emissive_texture(TextureReader& textures, int texture, const std::string& who,
                            Material& material, Scene& scene) {
  if (texture < 0 || !emits(material)) return;
  try {
    material.emission *= textures.mean_color(texture, who);
  } catch (const Error& error) {
    scene.warnings.push_back(std::string(error.what()) + "; its emission goes untextured");
  }
}

/// When the image cannot be read, the surface keeps the factor's colour, with a warning.
void apply_color_texture(TextureReader& textures, int texture, const std::string& who,
                         Material& material, Scene& scene) {
  if (texture < 0) return;
  try {
    material.color_texture = textures.color_texture(texture, who);
  } catch (const Error& error) {
    scene.warnings.push_back(std::string(error.what()) + "; its colour goes untextured");
  }
}

/// The materials that placed primitives use.
struct ShownMaterials {
  std::vector<bool> by_triangles;  ///< per glTF material: whether triangles use it
  bool none = false;               ///< a shown primitive has no material
};

ShownMaterials shown_materials(const Document& document, const std::vector<PlacedNode>& placed,
                               bool with_lines) {
  const auto& model = document.model;
  ShownMaterials shown{std::vector<bool>(model.materials.size(), false), false};
  std::vector<bool> seen(model.meshes.size(), false);
  for (const PlacedNode& at : placed) {
    const int mesh = model.nodes[static_cast<std::size_t>(at.node)].mesh;
    if (mesh < 0 || seen[static_cast<std::size_t>(mesh)]) continue;
    seen[static_cast<std::size_t>(mesh)] = true;
    for (const auto& primitive : model.meshes[static_cast<std::size_t>(mesh)].primitives) {
      const bool triangles = primitive.mode >= TINYGLTF_MODE_TRIANGLES;
      if (!triangles && !(with_lines && is_of_lines(primitive))) continue;
      if (primitive.material < 0) {
        shown.none = true;
      } else if (triangles) {
        shown.by_triangles[static_cast<std::size_t>(primitive.material)] = true;
      }
    }
  }
  return shown;
}

}  // namespace

bool emits(const Material& material) {
  return material.emission.x > 0 || material.emission.y > 0 || material.emission.z > 0;
}

MaterialSet read_materials(const Document& document, const std::vector<PlacedNode>& placed,
                           bool with_lines, bool with_colors, Scene& scene) {
  const auto& given = document.model.materials;
  const ShownMaterials shown = shown_materials(document, placed, with_lines);
  const auto needs_image = [&](std::size_t i) {
    return shown.by_triangles[i] && base_color(given[i]).texture.texture >= 0 &&
           (with_colors || alpha_mode(given[i]) != AlphaMode::opaque);
  };
  TextureReader textures(document, with_colors, scene);
  std::vector<int> expected;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (needs_image(i)) expected.push_back(base_color(given[i]).texture.texture);
  textures.expect(expected);
  MaterialSet set;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string who = element("material", i, given[i].name);
    const BaseColor base = base_color(given[i]);
    Material material;
    material.name = given[i].name.empty() ? fmt::format("material_{}", i) : one_line(given[i].name);
    material.alpha_mode = alpha_mode(given[i]);
    material.alpha = static_cast<float>(std::clamp(base.factor[3], 0.0, 1.0));
    for (int channel = 0; channel < 3; ++channel) {
      material.color[channel] =
          static_cast<float>(std::clamp(base.factor[static_cast<std::size_t>(channel)], 0.0, 1.0));
    }
    material.alpha_cutoff = static_cast<float>(given[i].alphaCutoff);
    material.double_sided = given[i].doubleSided;
    material.emission = emission_factor(given[i]);
    if (shown.by_triangles[i]) {
      apply_emissive_texture(textures, given[i].emissiveTexture.index, who, material, scene);
      if (material.alpha_mode != AlphaMode::opaque && base.texture.texture >= 0) {
        material.alpha_texture = textures.alpha_texture(base.texture.texture, who);
      }
      if (with_colors) apply_color_texture(textures, base.texture.texture, who, material, scene);
    }
    scene.materials.push_back(std::move(material));
    set.lookups.push_back(alpha_lookup(base.texture));
  }
  set.default_material = static_cast<std::uint32_t>(given.size());
  if (shown.none) {
    Material none;
    none.name = "default";
    scene.materials.push_back(std::move(none));
    set.lookups.emplace_back();
  }
  return set;
}

}  // namespace dapple::gltf
