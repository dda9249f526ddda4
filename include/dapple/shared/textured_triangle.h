/* A triangle whose opacity varies, in 24 bytes: texture coordinates, vertex alphas, the index of
   a material and the size of a texel; and how they are decoded. host/bvh/storage/textured_triangle.cpp
   encodes. */
#ifndef DAPPLE_SHARED_TEXTURED_TRIANGLE_H
#define DAPPLE_SHARED_TEXTURED_TRIANGLE_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Two words a corner, for u and v. Each has 21 bits of its coordinate uppermost, in steps of a
   power of two that all six share. Below them the vertex alpha: upper 11 bits in the first word,
   lowest in the second; below that, of the second: bits 0 to 9 of the material (corner 0), bits
   10 to 14 and the size of a texel above them (corner 1), the step and three flags (corner 2).

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

#define DAPPLE_MAX_TEXTURED_MATERIALS 0x8000u

/* The texel is 2^(code - bias) wide, in the object's units; code 0: not known. */
#define DAPPLE_TEXEL_SIZE_BIAS 25
#define DAPPLE_TEXEL_SIZE_CODES 32

DAPPLE_FUNCTION uint has_texture(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return triangle->corner[2][1] & DAPPLE_HAS_TEXTURE;
}

/* Of words, or of vectors of them: `first` and `second` are a corner's, `last` is the second word
   of corner 2. */

/* Which of the scene's materials, of the second words of corners 0 and 1. */
#define DAPPLE_MATERIAL_NUMBER(of_corner_0, of_corner_1) \
  (((of_corner_0) & 1023u) | ((of_corner_1) & 31u) << 10)

/* COLOR_0.a in 1/4080: the material's factor is not in it. */
#define DAPPLE_VERTEX_ALPHA(first, second) (((first) & 2047u) << 1 | ((second) >> 10 & 1u))

/* Of corner 1's second word. */
#define DAPPLE_TEXEL_SIZE_CODE(word) ((word) >> 5 & 31u)

/* A word's coordinate, in steps from the lowest that could be encoded. */
#define DAPPLE_UV_CODE(word) ((word) >> 11)

/* The code of 0. */
#define DAPPLE_UV_ORIGIN(last) (((last) & DAPPLE_UV_FROM_MIDDLE) * \
                                (DAPPLE_UV_CODES / 2 / DAPPLE_UV_FROM_MIDDLE))

/* The step, as the bits of a float. */
#define DAPPLE_UV_STEP_BITS(last) ((((last) & DAPPLE_UV_EXPONENT) + 64u) << 23)

/* Which of the scene's materials. */
DAPPLE_FUNCTION uint textured_material(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return DAPPLE_MATERIAL_NUMBER(triangle->corner[0][1], triangle->corner[1][1]);
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(TexturedTriangle) == 24);
}  // namespace dapple
#endif

#endif
