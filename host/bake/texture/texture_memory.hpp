// What a texture takes while it is baked. In: its size, the texture coordinates of all triangles,
// and what is baked. Out: bytes, or an Error where the machine has too few.
#pragma once

#include "bake/texture/texture_layout.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Bytes of the sums of all texels that the triangles of one mesh cover at once, and of the
/// texture.
double texture_bake_bytes(const TextureLayout& layout, const BakeOptions& options,
                          std::size_t lights);

/// Throws Error usage if that is more than `machine` bytes; 0: not known.
void check_texture_memory(const TextureLayout& layout, const BakeOptions& options,
                          std::size_t lights, double machine);

}  // namespace dapple
