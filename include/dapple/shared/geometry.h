/* Records that the leaves of the BVHs refer to: triangle blocks, opacity textures, materials of
   textured triangles, and instances. Segments of strands are in segment_block.h. */
#ifndef DAPPLE_SHARED_GEOMETRY_H
#define DAPPLE_SHARED_GEOMETRY_H

#include "dapple/shared/language.h"
#include "dapple/shared/segment_block.h"
#include "dapple/shared/textured_triangle.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Eight triangles, one in each vector lane: vertex[corner][axis][lane], bit for bit those of the
   mesh, so that triangles which share an edge in the mesh share it here. `opacity` is in [0,1], or
   it is -(1 + index) of a TexturedTriangle. Unused lanes are all zeros; rays never hit them. */
typedef struct DAPPLE_CACHE_ALIGNED TriangleBlock {
  float vertex[3][3][8];
  float opacity[8];
} TriangleBlock;

#define DAPPLE_WRAP_REPEAT 0u
#define DAPPLE_WRAP_CLAMP 1u
#define DAPPLE_WRAP_MIRROR 2u

/* Flags of a texture: DAPPLE_TEXTURE_FLAGS() of how it is wrapped along u and v, and DAPPLE_NEAREST if it is looked
   up without interpolation. */
#define DAPPLE_NEAREST 16u
#define DAPPLE_TEXTURE_FLAGS(wrap_s, wrap_t) ((wrap_s) | (wrap_t) << 2)
#define DAPPLE_WRAP_S(flags) ((flags) & 3u)
#define DAPPLE_WRAP_T(flags) ((flags) >> 2 & 3u)

/* An 8-bit alpha image inside the texel buffer. */
typedef struct TextureRecord {
  uint offset; /* of its first texel, in 16-byte units, so that 64 GB can be addressed */
  uint width;
  uint height;
  uint flags; /* DAPPLE_TEXTURE_FLAGS(), DAPPLE_NEAREST */
} TextureRecord;

/* The largest number of coarser levels of a texture. With 65,536 texels along an axis, the last
   level has one. */
#define DAPPLE_MAX_MIPS 16

/* Material of textured triangles: opacity = vertex alpha (interpolated) * alpha * texture alpha. If
   cutoff >= 0, the opacity is 1 where this product is >= cutoff, else 0. If a footprint covers many
   texels, their mean is read from a mip pyramid (Williams, "Pyramidal Parametrics", 1983). Level k
   has half the width and height of level k - 1, rounded down. It holds mean texture alphas, or mean
   opacities if there is a cutoff. */
typedef struct MaterialRecord {
  TextureRecord texture; /* zeros for none */
  float alpha;           /* baseColorFactor.a */
  float cutoff;          /* < 0: blended */
  uint mips;             /* levels above the texture itself */
  uint spare;
  uint mip_offset[DAPPLE_MAX_MIPS]; /* of level 1 and up, as TextureRecord::offset */
} MaterialRecord;

/* A placed object. p_object = to_object * (p_world, 1), rows of a 3x4 matrix. Rays keep their
   parameter t, because directions are transformed without normalizing. */
typedef struct InstanceRecord {
  float to_object[12];
  float to_world[12];
  float inverse_det;        /* 1 / |det of to_world|, which projected areas of boxes take whole, since
                               directions are not normalized: kernels/opacity/footprint.clh */
  uint root;                /* the object's root node */
  uint light;               /* 1 + the mesh light it emits for; 0: none */
  uint source;              /* index in Scene::instances */
} InstanceRecord;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(TriangleBlock) == 320);
static_assert(sizeof(TextureRecord) == 16);
static_assert(sizeof(MaterialRecord) == 96);
static_assert(sizeof(InstanceRecord) == 112);
}  // namespace dapple
#endif

#endif
