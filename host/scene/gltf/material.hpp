// Materials: opacity, its texture and how that is looked up, emission. In come the
// document and which materials are shown; out go Scene::materials and Scene::textures.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"

namespace dapple::gltf {

/// How a material's alpha texture is looked up: the TEXCOORD set, and the affine map of
/// KHR_texture_transform from its coordinates to the texture's.
struct AlphaLookup {
  int texcoord = 0;
  V2f du{1, 0};  ///< change of the result along u
  V2f dv{0, 1};  ///< change of the result along v
  V2f offset{0, 0};
  bool has_texture = false;  ///< the material has one, read or not

  [[nodiscard]] V2f apply(V2f uv) const { return uv.x * du + uv.y * dv + offset; }
};

/// The glTF materials in their order, one AlphaLookup for each of Scene::materials, and
/// the place of the material "default", which primitives without one get.
struct MaterialSet {
  std::vector<AlphaLookup> lookups;
  std::uint32_t default_material = 0;

  [[nodiscard]] std::uint32_t index_of(int gltf_material) const {
    return gltf_material >= 0 ? static_cast<std::uint32_t>(gltf_material) : default_material;
  }
};

/// Reads images only for materials that a triangle primitive of `placed` uses; `with_lines` says
/// whether lines are shown too. Throws Error input when an image whose alpha matters cannot be
/// read.
MaterialSet read_materials(const Document& document, const std::vector<PlacedNode>& placed,
                           bool with_lines, Scene& scene);

bool emits(const Material& material);

}  // namespace dapple::gltf
