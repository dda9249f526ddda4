/* opacity_lookup.clh as a kernel: texture coordinates in, alpha out. */
#include "opacity_lookup.clh"

__kernel void look_up(__global const TextureRecord* textures, __global const uchar* texels,
                      __global const float* uvs, __global float* alphas, uint texture, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const Scene scene = {0, 0, 0, textures, texels, 0};
  alphas[item] = read_texels(scene, find_texels(textures[texture], vload2(item, uvs)));
}

/* Barycentrics in, opacity of textured triangle `triangle` out. */
__kernel void look_up_triangle(__global const TexturedTriangle* textured,
                               __global const TextureRecord* textures,
                               __global const uchar* texels, __global const float* barycentrics,
                               __global float* opacities, uint triangle, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const Scene scene = {0, 0, textured, textures, texels, 0};
  const float2 at = vload2(item, barycentrics);
  opacities[item] = textured_opacity(scene, -1.0f - (float)triangle, at.x, at.y);
}
