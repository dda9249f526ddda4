/* The queues between passes: rays, what they found, and the points they start from. */
#ifndef DAPPLE_SHARED_RAY_H
#define DAPPLE_SHARED_RAY_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* direction is a unit vector in world space. The footprint at distance t covers
   first_area + solid_angle * t^2. */
typedef struct Ray {
  float origin[3];
  float t_max;
  float direction[3];
  float solid_angle; /* steradians, [0, 2 pi] */
  float first_area;  /* square metres */
  uint light;        /* 1 + the mesh light this ray is aimed at; 0: none */
  float weight;      /* factor of the ray's transmittance in its pass */
  uint key;          /* random bits: closest_hit.cl, footprint_spread() */
} Ray;

/* Random scale of a ray's footprint, 1/2 to 2. A node becomes covered for some rays before others,
   so that nothing pops as the camera moves. */
DAPPLE_FUNCTION float footprint_spread(uint key) {
  const float root = 0.70710678f * (1.0f + (float)(key >> 8) * (1.0f / 16777216.0f));
  return root * root;
}

/* Result of an occlusion ray. */
typedef struct Occlusion {
  float transmittance; /* [0,1] */
  uint visits;         /* pack_costs() of the ray */
} Occlusion;

/* Rays of a point that one RaySums is of, at most. */
#define DAPPLE_SUMMED_RAYS 64u

/* Sums over rays of a point. */
typedef struct RaySums {
  float weight;       /* of Ray::weight */
  float seen;         /* of Ray::weight times the transmittance */
  float direction[3]; /* of directions times the same */
} RaySums;

/* Occlusion::visits and SurfacePoint::visits: nodes visited | primitives tested << 16, each clamped to 65535. */
DAPPLE_FUNCTION uint pack_costs(uint visits, uint tests) {
  return (visits < 65535u ? visits : 65535u) | (tests < 65535u ? tests : 65535u) << 16;
}
DAPPLE_FUNCTION uint visits_of(uint costs) { return costs & 65535u; }
DAPPLE_FUNCTION uint tests_of(uint costs) { return costs >> 16; }

/* Camera rays that one work-item of the camera pass traces as a packet. */
#define DAPPLE_ITEM_RAYS 64u

/* Camera rays in one vector. */
#define DAPPLE_GROUP_RAYS 16u

/* The largest number of samples that share a camera ray; a power of two. */
#define DAPPLE_MAX_CAMERA_SPLITTING 4u

/* Consecutive items of one ticket; neighbouring items read mostly the same memory. */
#define DAPPLE_ITEMS_PER_TICKET 4u

/* Number of samples in a SampleHits. */
#define DAPPLE_HIT_BITS 16u

/* Results of DAPPLE_HIT_BITS consecutive samples of a slice. */
typedef struct SampleHits {
  uint hits;       /* bit i: sample i of the record hit a surface */
  uint first_slot; /* index of the first hit among all hits of the slice */
  /* Totals of the work-item that traced the samples: nodes that its packet visited, and tests of a
     ray with a triangle or segment. */
  uint visits, tests;
} SampleHits;

/* In place of an instance's index: the scene has no instances, and rays are in world space. */
#define DAPPLE_WORLD 0xffffffffu

/* Where a camera ray hit a surface; t < 0: it hit none. Where a shading pass follows the camera
   pass, `t` holds bits of whole numbers: until then of the instance that was hit, whose primitive
   is in `visits`; from then on of a direction_code() or 0, see shade_point(). */
typedef struct SurfacePoint {
  float position[3];
  float t;
  float normal[3]; /* unit, turned to the viewer; geometric until the shading pass */
  float offset;    /* metres along the normal to the origins of rays; exceeds rounding errors */
  float area;      /* square metres across the ray that the pixel's share covers */
  uint pixel;      /* index in the whole picture, row-major; seeds the random numbers */
  uint sample;     /* number of the sample in its pixel */
  uint visits;     /* as in Occlusion, of closest_hits(); 0 of camera rays */
} SurfacePoint;

/* Colour of the surface that a sample hit, linear, [0,1]. */
typedef struct SampleAlbedo {
  float color[3];
} SampleAlbedo;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(Ray) == 48);
static_assert(sizeof(Occlusion) == 8);
static_assert(sizeof(RaySums) == 20);
static_assert(sizeof(SampleHits) == 16);
static_assert(sizeof(SurfacePoint) == 48);
static_assert(sizeof(SampleAlbedo) == 12);
}  // namespace dapple
#endif

#endif
