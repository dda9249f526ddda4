/* Normals at the corners of a triangle in 8 bytes, and octahedral codes of unit vectors (Cigolle et
   al., "A Survey of Efficient Representations for Independent Unit Vectors", 2014). The host
   encodes (host/device/upload/normal_upload.cpp), the shading pass decodes. */
#ifndef DAPPLE_SHARED_CORNER_NORMALS_H
#define DAPPLE_SHARED_CORNER_NORMALS_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Three codes of 21 bits: corner 0 in the lowest bits of words[0], and so on. A code is 1 + x +
   DAPPLE_NORMAL_SIDE * y, of a point of the octahedral square. All bits 0: the triangle is flat, its
   own normal serves. */
typedef struct CornerNormals {
  uint words[2];
} CornerNormals;

/* An array of CornerNormals begins with a word for each triangle block, padded to a multiple of 16
   words: the number of the group of eight, counted from the beginning of the array, that holds the
   normals of its lanes; 0: the block is flat. */
#define DAPPLE_NORMAL_GROUP 8u

#define DAPPLE_NORMAL_SIDE 1448u /* points along a side of the square; its square is below 2^21 */

DAPPLE_FUNCTION uint corner_code(CornerNormals normals, uint corner) {
  if (corner == 0u) return normals.words[0] & 0x1fffffu;
  if (corner == 1u) return normals.words[0] >> 21 | (normals.words[1] & 1023u) << 11;
  return normals.words[1] >> 10 & 0x1fffffu;
}

/* The vector, of length 1/2 or more, that the point (x, y) of the square [-1, 1]^2 stands for. */
DAPPLE_FUNCTION void octahedral_vector(float x, float y, float* vector) {
  const float z = 1.0f - (x < 0.0f ? -x : x) - (y < 0.0f ? -y : y);
  const float folded = z < 0.0f ? -z : 0.0f;
  vector[0] = x < 0.0f ? x + folded : x - folded;
  vector[1] = y < 0.0f ? y + folded : y - folded;
  vector[2] = z;
}

/* The point of the square for a vector that is not zero. */
DAPPLE_FUNCTION void octahedral_point(const float* vector, float* x, float* y) {
  const float ax = vector[0] < 0.0f ? -vector[0] : vector[0];
  const float ay = vector[1] < 0.0f ? -vector[1] : vector[1];
  const float az = vector[2] < 0.0f ? -vector[2] : vector[2];
  const float inverse = 1.0f / (ax + ay + az);
  const float px = ax * inverse, py = ay * inverse;
  const float qx = vector[2] < 0.0f ? 1.0f - py : px, qy = vector[2] < 0.0f ? 1.0f - px : py;
  *x = vector[0] < 0.0f ? -qx : qx;
  *y = vector[1] < 0.0f ? -qy : qy;
}

/* Like octahedral_vector(), of a corner's code. */
DAPPLE_FUNCTION void corner_vector(uint code, float* vector) {
  const float step = 2.0f / (float)(DAPPLE_NORMAL_SIDE - 1u);
  const uint point = code - 1u;
  octahedral_vector((float)(point % DAPPLE_NORMAL_SIDE) * step - 1.0f,
                    (float)(point / DAPPLE_NORMAL_SIDE) * step - 1.0f, vector);
}

/* A direction in 32 bits, never 0. */
DAPPLE_FUNCTION uint direction_code(const float* direction) {
  float x, y;
  octahedral_point(direction, &x, &y);
  return (uint)((x + 1.0f) * 32767.0f + 1.5f) | (uint)((y + 1.0f) * 32767.0f + 1.5f) << 16;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(CornerNormals) == 8);
}  // namespace dapple
#endif

#endif
