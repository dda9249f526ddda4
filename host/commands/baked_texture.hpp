// A baked texture as part of a glTF file. In: the file, its scene and what bake() returned. Out:
// texture coordinates that the file has, and primitives with the ones that were made.
#pragma once

#include <string>
#include <vector>

#include "dapple/bake.hpp"
#include "scene/gltf/source_file.hpp"
#include "scene/gltf/texture_writer.hpp"

namespace dapple {

/// Texture coordinates that a file has for all of its triangles.
struct FileUvs {
  std::vector<std::vector<V2f>> uvs;  ///< as BakeOptions::texture_uvs; empty: none can be used
  std::uint32_t set = 0;              ///< n of TEXCOORD_n
  std::string note;                   ///< why others cannot be used; empty: there are none
};

/// TEXCOORD_1, else TEXCOORD_0, if all primitives have it, inside of [0,1] and without overlaps.
FileUvs choose_uvs(const gltf::SourceFile& file, const Scene& scene, std::uint32_t size);

/// The primitives that the texture is on. `set`: of FileUvs, for a layout that came from there.
std::vector<gltf::TexturedPrimitive> textured_primitives(const gltf::SourceFile& file,
                                                         const Scene& scene,
                                                         const TextureLayout& layout,
                                                         std::uint32_t set);

/// AO as an 8-bit grey PNG. It is linear, as glTF says.
std::string occlusion_png(const BakedTexture& texture);

/// Bent normals as an EXR of the layer "bent": X, Y and Z in object space.
void write_bent_exr(const BakedTexture& texture, const std::string& path);

}  // namespace dapple
