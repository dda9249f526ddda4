/* A light as the kernels sample it. The kernels compute the irradiance of a light of radiance 1.
   The host then multiplies it by the light's radiance. */
#ifndef DAPPLE_SHARED_LIGHT_RECORD_H
#define DAPPLE_SHARED_LIGHT_RECORD_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

#define DAPPLE_LIGHT_RECT 0u
#define DAPPLE_LIGHT_SPHERE 1u
#define DAPPLE_LIGHT_SUN 2u
#define DAPPLE_LIGHT_MESH 3u
#define DAPPLE_LIGHT_DOME 4u
#define DAPPLE_LIGHT_DISK 5u
#define DAPPLE_LIGHT_PARALLELOGRAM 6u /* a rect whose edges or direction are not perpendicular */

typedef struct LightRecord {
  float position[3];
  float radius;        /* sphere, disk: metres */
  float direction[3];  /* rect, disk: emitting side; sun, spot: the way light travels */
  float one_minus_cos; /* sun: 1 - cosine of its angular radius */
  float edge_u[3]; /* rect: the shorter full edge; disk: radius along an axis */
  float area;      /* rect, mesh, disk: square metres */
  float edge_v[3];
  float inner_cone; /* spot: 1 - cosine of its cones; no cone: outer_cone is 2 */
  float outer_cone;
  uint kind;
  uint first_triangle; /* mesh: in the emitter triangle buffer */
  uint triangle_count;
  uint two_sided;
  uint id;                /* mesh: 1 + index of the light; else 0 */
  uint environment_first; /* dome: index of its first float, see kernels/lights/dome.clh */
  uint environment_width, environment_height;
  float rotation; /* dome: radians about +Y */
  uint sequence;  /* of random numbers; lights with the same one have correlated noise */
} LightRecord;

/* A triangle of a mesh light in world space. The triangles of a light are the leaves of a binary
   tree, in order: its root is all of them, and a node of triangles [a, b) has the children [a, m)
   and [m, b), m = (a + b) / 2. Triangle m says where they are; none has two such nodes, the first
   has none. */
typedef struct EmitterTriangle {
  float vertex[3];
  float area; /* that shines, square metres: times the mean opacity */
  float edge1[3];
  float left_share; /* of the node's area in [a, m) */
  float edge2[3];
  float spare;
  float left[6], right[6]; /* boxes around the children: centre, half sides */
} EmitterTriangle;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(LightRecord) == 108);
static_assert(sizeof(EmitterTriangle) == 96);
}  // namespace dapple
#endif

#endif
