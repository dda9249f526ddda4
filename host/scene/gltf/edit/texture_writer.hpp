// Adds a baked occlusion texture to a glTF file. In: the image, and the texture coordinates of the
// primitives that it is on. Out: changes of an Editor: primitives with a TEXCOORD_n more, and
// materials with an occlusionTexture.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/edit/editor.hpp"

namespace dapple::gltf {

/// A primitive with texture coordinates of its own.
struct TexturedPrimitive {
  std::uint32_t mesh = 0, primitive = 0;  ///< indices in the file
  std::uint32_t uv_set = 0;               ///< n of TEXCOORD_n; lower ones that lack become 0, 0
  /// For each new vertex the vertex of the file whose copy it is, and its texture coordinates.
  /// Empty: the file has TEXCOORD_n, and the vertices stay as they are.
  std::vector<std::uint32_t> source;
  std::vector<Imath::V2f> uvs;
  std::vector<std::uint32_t> indices;  ///< of the new vertices, three a triangle
};

/// Replaces the vertices of primitives that have new ones, with all attributes and morph targets,
/// and gives the materials of all the texture `png` as occlusion. Materials that other primitives
/// use too are copied. An occlusion texture that a material has is replaced; its strength and
/// extras stay. Returns how many are. The file of a .gltf's image is named as Editor::add_image()
/// says.
std::size_t add_occlusion_texture(Editor& editor, const std::vector<TexturedPrimitive>& primitives,
                                  const std::string& png);

/// The suffix of that image's file.
inline constexpr const char* kOcclusionSuffix = "_ao";

}  // namespace dapple::gltf
