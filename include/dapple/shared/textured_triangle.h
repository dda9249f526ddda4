/* A triangle whose opacity varies, in 24 bytes: texture coordinates, vertex alphas and the
   index of a material; and how they are decoded. host/bvh/textured_triangle.cpp encodes. */
#ifndef DAPPLE_SHARED_TEXTURED_TRIANGLE_H
#define DAPPLE_SHARED_TEXTURED_TRIANGLE_H

#include "language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Two words a corner, for u and v. Each has 21 bits of its coordinate uppermost, in steps of a
   power of two that all six share. Below them the vertex alpha: upper 11 bits in the first word,
   lowest in the second; below that, of the second: bits 0 to 9 of the material (corner 0), bits
   10 to 19 (corner 1), the step and three flags (corner 2).

   Coordinates and not edges, so that neighbours agree at the vertices they share; of 21 bits,
   since 16 for edges beside a vertex of two floats moved cards by up to 1/64 of a texel: 980 of
   100,000 rays through the game pine were off by more than 0.001 in transmittance, 22 are. */
typedef struct TexturedTriangle {
  uint corner[3][2];
} TexturedTriangle;

#define DAPPLE_UV_CODES 0x200000       /* of a coordinate: 0 and up to below this */
#define DAPPLE_UV_EXPONENT 0x7fu       /* of the step, biased by 63 */
#define DAPPLE_UV_FROM_MIDDLE 0x80u    /* half the codes are of negative coordinates */
#define DAPPLE_HAS_TEXTURE 0x100u      /* the material's counts */
#define DAPPLE_HAS_VERTEX_ALPHA 0x200u /* alphas are not 1 all three */

/* Steps of vertex alphas: those of 8-bit colours are among them, 16 apart. */
#define DAPPLE_ALPHA_ONE 4080

#define DAPPLE_MOST_TEXTURED_MATERIALS 0x100000u

/* Which of the scene's materials. */
DAPPLE_FUNCTION uint textured_material(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return (triangle->corner[0][1] & 1023u) | (triangle->corner[1][1] & 1023u) << 10;
}

DAPPLE_FUNCTION uint has_texture(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return triangle->corner[2][1] & DAPPLE_HAS_TEXTURE;
}

DAPPLE_FUNCTION uint has_vertex_alpha(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return triangle->corner[2][1] & DAPPLE_HAS_VERTEX_ALPHA;
}

/* COLOR_0.a in 1/4080: the material's factor is not in it. */
DAPPLE_FUNCTION int vertex_alpha(DAPPLE_GLOBAL const TexturedTriangle* triangle, uint corner) {
  return (int)((triangle->corner[corner][0] & 2047u) << 1 |
               (triangle->corner[corner][1] >> 10 & 1u));
}

/* Coordinate `axis`, 0 for u, 1 for v, in steps from the lowest that could be encoded. */
DAPPLE_FUNCTION int uv_code(DAPPLE_GLOBAL const TexturedTriangle* triangle, uint corner,
                            uint axis) {
  return (int)(triangle->corner[corner][axis] >> 11);
}

/* The code of 0. */
DAPPLE_FUNCTION int uv_origin(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return triangle->corner[2][1] & DAPPLE_UV_FROM_MIDDLE ? DAPPLE_UV_CODES / 2 : 0;
}

DAPPLE_FUNCTION float uv_step(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return dapple_bits_to_float(((triangle->corner[2][1] & DAPPLE_UV_EXPONENT) + 64u) << 23);
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(TexturedTriangle) == 24);
}  // namespace dapple
#endif

#endif
