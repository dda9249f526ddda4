// Describes a scene as a GLB file (glTF 2.0 Specification, Khronos). In: a scene. Out: the JSON
// text and the memory sections of the binary chunk that follows it; glb_writer.cpp writes both.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// `sections` make up the binary chunk, in this order. They point into the scene or into the
/// `made_` arrays.
struct GlbLayout {
  std::string json;
  std::vector<std::span<const std::byte>> sections;
  std::size_t byte_count = 0;  ///< of all sections; a multiple of 4
  std::vector<std::vector<std::uint32_t>> made_indices;
  std::vector<std::vector<float>> made_colours;
  std::vector<std::vector<V3f>> made_vectors;
};

/// Textures are left out. The scene must outlive the layout. Throws Error failed when a vertex is
/// not finite, and Error usage when a mesh has strands: glTF can hold neither.
GlbLayout lay_out_glb(const Scene& scene);

}  // namespace dapple
