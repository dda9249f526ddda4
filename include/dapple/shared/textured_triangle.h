/* A triangle with varying opacity in 24 bytes: texture coordinates, vertex alphas, a material index
   and the size of a texel. The functions and macros decode them;
   host/bvh/storage/textured_triangle.cpp encodes them. */
#ifndef DAPPLE_SHARED_TEXTURED_TRIANGLE_H
#define DAPPLE_SHARED_TEXTURED_TRIANGLE_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Each corner has two words, for u and v. The upper 21 bits of a word are the coordinate, in steps
   of a power of two that all six coordinates share. The lower 11 bits of the first word are the
   upper bits of the vertex alpha. The second word continues with the lowest bit of the alpha, and
   then holds bits 0 to 9 of the material index (corner 0), bits 10 to 14 of it and above them the
   size of a texel (corner 1), or the step and three flags (corner 2).

   Corners are stored, not edges, so that neighbouring triangles agree at shared vertices. 16 bits
   would move textures by up to 1/64 of a texel. */
typedef struct TexturedTriangle {
  uint corner[3][2];
} TexturedTriangle;

#define DAPPLE_UV_CODES 0x200000       /* coordinates are from 0 to below this */
#define DAPPLE_UV_EXPONENT 0x7fu       /* exponent of the step, biased by 63 */
#define DAPPLE_UV_FROM_MIDDLE 0x80u    /* half of the codes stand for negative coordinates */
#define DAPPLE_HAS_TEXTURE 0x100u      /* the material's texture is looked up */
#define DAPPLE_HAS_VERTEX_ALPHA 0x200u /* some alpha is not 1 */

/* The code of vertex alpha 1. Alphas of 8-bit colours are multiples of 16. */
#define DAPPLE_ALPHA_ONE 4080

/* Indices of textured triangles are stored as floats. */
#define DAPPLE_MAX_TEXTURED_TRIANGLES 0x1000000u
#define DAPPLE_MAX_TEXTURED_MATERIALS 0x8000u

/* A texel is 2^(code - bias) wide, in the object's units; code 0: the size is unknown. */
#define DAPPLE_TEXEL_SIZE_BIAS 25
#define DAPPLE_TEXEL_SIZE_CODES 32

DAPPLE_FUNCTION uint has_texture(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return triangle->corner[2][1] & DAPPLE_HAS_TEXTURE;
}

/* The macros take words or vectors of words: `first` and `second` are the words of a corner, `last`
   is the second word of corner 2. */

/* The material index, from the second words of corners 0 and 1. */
#define DAPPLE_MATERIAL_NUMBER(of_corner_0, of_corner_1) \
  (((of_corner_0) & 1023u) | ((of_corner_1) & 31u) << 10)

/* COLOR_0.a in units of 1/4080, without the material's factor. */
#define DAPPLE_VERTEX_ALPHA(first, second) (((first) & 2047u) << 1 | ((second) >> 10 & 1u))

/* The code of the texel's size, from corner 1's second word. */
#define DAPPLE_TEXEL_SIZE_CODE(word) ((word) >> 5 & 31u)

/* The coordinate of a word, in steps above the lowest one that can be encoded. */
#define DAPPLE_UV_CODE(word) ((word) >> 11)

/* The code of coordinate 0. */
#define DAPPLE_UV_ORIGIN(last) (((last) & DAPPLE_UV_FROM_MIDDLE) * \
                                (DAPPLE_UV_CODES / 2 / DAPPLE_UV_FROM_MIDDLE))

/* The step, as the bits of a float. */
#define DAPPLE_UV_STEP_BITS(last) ((((last) & DAPPLE_UV_EXPONENT) + 64u) << 23)

/* The index of the triangle's material. */
DAPPLE_FUNCTION uint textured_material(DAPPLE_GLOBAL const TexturedTriangle* triangle) {
  return DAPPLE_MATERIAL_NUMBER(triangle->corner[0][1], triangle->corner[1][1]);
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(TexturedTriangle) == 24);
}  // namespace dapple
#endif

#endif
