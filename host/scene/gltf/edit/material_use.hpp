// Which materials a primitive has, and which texture coordinates these use, in the JSON of a glTF
// document.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/edit/extension_use.hpp"

namespace dapple::gltf {

inline constexpr int kNoMaterial = -1;

inline int material_of(const Json& primitive) { return primitive.value("material", kNoMaterial); }

/// Calls visit(mapping) for each mapping of KHR_materials_variants to one of `count` materials.
template <class PrimitiveJson, class Visit>
void for_each_variant(PrimitiveJson& primitive, std::size_t count, Visit visit) {
  if (!has_extension(primitive, extension::kVariants)) return;
  auto& variants = primitive["extensions"][extension::kVariants];
  if (!variants.is_object() || !variants.contains("mappings")) return;
  for (auto& mapping : variants["mappings"]) {
    if (!mapping.is_object() || !mapping.contains("material")) continue;
    const auto& material = mapping["material"];
    if (material.is_number_unsigned() && material.template get<std::uint64_t>() < count)
      visit(mapping);
  }
}

/// The key of the first texture of a material, or of its extensions, that uses TEXCOORD_`set`, such
/// as "baseColorTexture"; empty if none does.
std::string texture_with_uvs(const Json& material, std::uint32_t set);

}  // namespace dapple::gltf
