/* opacity_lookup.clh as kernels. */
#include "opacity_lookup.clh"

/* Texture coordinates in, alpha out. */
__kernel void look_up(__global const TextureRecord* textures, __global const uchar* texels,
                      __global const float* uvs, __global float* alphas, uint texture, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const Scene scene = {0, 0, 0, 0, 0, texels, 0};
  alphas[item] = read_texels(scene, find_texels(textures[texture], vload2(item, uvs)));
}

/* Barycentrics in, opacity of textured triangle `triangle` out. */
__kernel void look_up_triangle(__global const TexturedTriangle* textured,
                               __global const MaterialRecord* materials,
                               __global const uchar* texels, __global const float* barycentrics,
                               __global float* opacities, uint triangle, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const Scene scene = {0, 0, 0, textured, materials, texels, 0};
  const float2 at = vload2(item, barycentrics);
  opacities[item] = textured_opacity(scene, -1.0f - (float)triangle, at.x, at.y);
}

/* Textured triangles in; u, v and alpha out as they are interpolated at each corner. */
__kernel void unpack_corners(__global const TexturedTriangle* textured, __global float* corners,
                             __global uint* materials, __global uint* textures, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  for (uint corner = 0; corner < 3u; ++corner) {
    const float u = corner == 1u ? 1.0f : 0.0f, v = corner == 2u ? 1.0f : 0.0f;
    const float3 found = (float3)(interpolated_uv(textured + item, u, v),
                                  interpolated_alpha(textured + item, u, v));
    vstore3(found, 3u * item + corner, corners);
  }
  materials[item] = textured_material(textured + item);
  textures[item] = has_texture(textured + item) ? 1u : 0u;
}
