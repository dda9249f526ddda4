/* Colours of surfaces, as the shading pass reads them: words that say where the colour of a triangle or
   segment comes from, and records of materials. host/device/upload/color_upload.cpp packs them. */
#ifndef DAPPLE_SHARED_SURFACE_COLOR_H
#define DAPPLE_SHARED_SURFACE_COLOR_H

#include "dapple/shared/geometry.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* The words begin with one for each block, of triangles, then of segments: where the entry begins that
   all lanes share, or, with DAPPLE_COLOR_LANES, where a word for each lane says so. An entry is the
   number of the material with flags; then, with DAPPLE_COLOR_UVS, the six words of a TexturedTriangle;
   then, with DAPPLE_COLOR_CORNERS, a colour for each corner, or each end of a segment. With
   DAPPLE_COLOR_OPACITY_UVS texture coordinates are those of the triangle's opacity. Surfaces without
   words of their own share the entries of their materials. */
#define DAPPLE_COLOR_LANES 0x80000000u
#define DAPPLE_COLOR_UVS 0x80000000u
#define DAPPLE_COLOR_OPACITY_UVS 0x40000000u
#define DAPPLE_COLOR_CORNERS 0x20000000u
#define DAPPLE_COLOR_MATERIAL 0x1fffffffu

/* A colour in 32 bits: 11 bits of red, the lowest, 11 of green and 10 of blue. A code stands for the square of
   its share of the largest code. */
#define DAPPLE_RED_CODES 2047
#define DAPPLE_GREEN_CODES 2047
#define DAPPLE_BLUE_CODES 1023

typedef struct ColorMaterial {
  float color[3]; /* factor, linear */
  uint mips;      /* coarser levels of the texture */
  uint width;     /* of the texture; 0: none */
  uint height;
  uint flags; /* as in TextureRecord */
  uint spare;
  uint offset[1 + DAPPLE_MAX_MIPS]; /* of the first texel of each level, the texture itself first */
  uint spares[3];
} ColorMaterial;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(ColorMaterial) == 112);
}  // namespace dapple
#endif

#endif
