// The opacity of triangles: one number, or a texture with factors that is looked up at each hit
// (kernels/opacity/opacity_lookup.clh) and averaged over areas for prefiltering.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "bvh/opacity/opaque_texels.hpp"
#include "bvh/storage/textured_triangle.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// Returns the opacity of the triangle, [0,1], if it is constant, else nothing. `texels`: of the
/// scene.
std::optional<float> uniform_opacity(const Scene& scene, const OpaqueTexels& texels,
                                     const Mesh& mesh, std::uint32_t triangle);

/// The opacity of a segment, [0,1]: the mean alpha of its ends, by the material, without textures.
float segment_opacity(const Scene& scene, const Mesh& mesh, std::uint32_t segment);

/// Throws Error failed if so many triangles of a mesh cannot have an opacity that varies.
void check_textured_count(const Scene& scene, std::size_t count);

/// Whether the alpha of the mesh's triangles is looked up in the texture of the material.
bool has_texture(const Material& material, const Mesh& mesh);

/// Returns the width of a texel of the material's texture on the triangle, in units of the object;
/// 0 if there is no texture, or if the triangle has no area in it.
float texel_size(const Scene& scene, const Mesh& mesh, std::uint32_t triangle);

/// Returns the alpha from which on a masked material is opaque, or -1 if alpha is the opacity.
float cutoff_of(const Material& material);

/// Returns the record by which the kernels look up the opacity of a triangle if it is not constant.
/// `averaged`: for wide footprints the kernels take the mean of the texels. Throws Error failed if
/// the index of the material is above the maximum of the records.
TexturedTriangle textured_triangle(const Scene& scene, const Mesh& mesh, std::uint32_t triangle,
                                   bool averaged);

}  // namespace dapple
