/* Functions of opacity_lookup.clh, called by kernels for the tests. */
#include "opacity/opacity_lookup.clh"

/* In: texture coordinates; out: alpha. */
__kernel void look_up(__global const TextureRecord* textures, __global const uchar* texels,
                      __global const float* uvs, __global float* alphas, uint texture, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const TextureRecord record = textures[texture];
  const TextureShapes shapes = {record.width, record.height, record.flags};
  const TexelAddresses addresses = find_texels(&shapes, uvs[2u * item], uvs[2u * item + 1u]);
  __global const uchar* first = texels + (ulong)record.offset * 16u;
  float16 texel[4];
  for (uint k = 0; k < 4u; ++k) texel[k] = first[addresses.index[k].s0];
  alphas[item] = mix_texels(texel, &addresses).s0;
}

/* In: barycentric coordinates; out: opacity of the textured triangle `triangle`. */
__kernel void look_up_triangle(__global const TexturedTriangle* textured,
                               __global const MaterialRecord* materials,
                               __global const uchar* texels, __global const float* barycentrics,
                               __global float* opacities, uint triangle, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const Scene scene = {0, 0, 0, textured, materials, texels, 0};
  TexturedHits hits;
  hits.count = 0u;
  /* Other lookups before and after it must have no effect. */
  const uint lane = item % DAPPLE_LOOKUPS;
  for (uint i = 0; i <= lane; ++i) {
    const float2 at = vload2(item - lane + i, barycentrics);
    add_hit(&hits, -1.0f - (float)triangle, at.x, at.y, 0.0f);
  }
  float opacity[DAPPLE_LOOKUPS];
  vstore16(look_up_opacities(scene, &hits), 0, opacity);
  const float2 at = vload2(item, barycentrics);
  const float16 alone =
      look_up_on_triangle(scene, 1u << lane, -1.0f - (float)triangle, at.x, at.y, 0.0f, 0);
  const float of_lane[DAPPLE_LOOKUPS] = {
      alone.s0, alone.s1, alone.s2, alone.s3, alone.s4, alone.s5, alone.s6, alone.s7,
      alone.s8, alone.s9, alone.sa, alone.sb, alone.sc, alone.sd, alone.se, alone.sf};
  /* The vector and the scalar lookup must agree. */
  opacities[item] = of_lane[lane] == opacity[lane] ? opacity[lane] : NAN;
}

/* In: textured triangles; out: u, v and alpha, interpolated at each corner. */
__kernel void unpack_corners(__global const TexturedTriangle* textured, __global float* corners,
                             __global uint* materials, __global uint* textures, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  for (uint corner = 0; corner < 3u; ++corner) {
    const float u = corner == 1u ? 1.0f : 0.0f, v = corner == 2u ? 1.0f : 0.0f;
    TexturedWords words;
    for (uint word = 0; word < 6u; ++word)
      words.word[word / 2u][word % 2u] = textured[item].corner[word / 2u][word % 2u];
    const float3 found =
        (float3)(interpolated_uv(&words, 0u, u, v).s0, interpolated_uv(&words, 1u, u, v).s0,
                 interpolated_alpha(&words, u, v).s0);
    vstore3(found, 3u * item + corner, corners);
  }
  materials[item] = textured_material(textured + item);
  textures[item] = has_texture(textured + item) ? 1u : 0u;
}
