// A baked texture as part of a glTF file. In: the file, its scene and what bake() returned. Out:
// texture coordinates that the file has, and primitives with the ones that were made.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dapple/bake.hpp"
#include "scene/gltf/edit/source_file.hpp"
#include "scene/gltf/edit/texture_writer.hpp"

namespace dapple {

/// Texture coordinates that a file has for all of its triangles.
struct FileUvs {
  std::vector<std::vector<V2f>> uvs;  ///< as BakeOptions::texture_uvs; empty: none can be used
  /// n of TEXCOORD_n; none: those that occlusion textures read, which may differ.
  std::optional<std::uint32_t> set = {};
  std::string note;  ///< why others cannot be used; empty: there are none
};

/// TEXCOORD_1, else TEXCOORD_0, else those that occlusion textures read, as an earlier bake made
/// them; if all primitives have it, inside of [0,1], without overlaps, and with an area for nearly
/// all triangles.
FileUvs choose_uvs(const gltf::SourceFile& file, const Scene& scene, const BakeOptions& options);

/// The primitives that the texture is on. `set`: of FileUvs, for a layout that came from there.
std::vector<gltf::TexturedPrimitive> textured_primitives(const gltf::SourceFile& file,
                                                         const Scene& scene,
                                                         const TextureLayout& layout,
                                                         std::optional<std::uint32_t> set);

/// Which texture coordinates show the texture. `fault`: FileUvs::note.
std::string coordinates_note(const TextureLayout& layout,
                             const std::vector<gltf::TexturedPrimitive>& primitives,
                             const std::string& fault);

/// AO as a grey PNG of 8 or 16 bits. It is linear, as glTF says.
std::string occlusion_png(const BakedTexture& texture, int bits);

/// All that was baked of the scene `source`, as an EXR with the layers ao, bent (X, Y and Z in
/// object space) and, for each light, light.NAME (R, G and B). The metadata have the options and
/// the bias, by the names that renders give them.
void write_baked_exr(const BakeResult& result, const std::string& source,
                     const BakeOptions& options, PendingFile& file);

}  // namespace dapple
