/* One parameter struct a kernel, passed by value. */
#ifndef DAPPLE_SHARED_PASS_PARAMS_H
#define DAPPLE_SHARED_PASS_PARAMS_H

#include "dapple/shared/language.h"
#include "dapple/shared/ray.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* What every traversal needs to know of the scene. */
typedef struct SceneParams {
  uint root;         /* node to start from */
  uint has_top;      /* 1: root is top-level; 0: it is the only object's, in world space */
} SceneParams;

/* Rays of a batch: they are sorted together and then cut into packets. At most so many rays of one point;
   so many rays of neighbouring pixels, and small batches at the end of a queue (experiment 304). */
#define DAPPLE_POINT_RAY_BATCH 512u
#define DAPPLE_PIXEL_RAY_BATCH 1024u
#define DAPPLE_SMALL_RAY_BATCH 256u

typedef struct OcclusionParams {
  SceneParams scene;
  uint ray_count;
  float footprint;            /* scale, >= 0 */
  float inverse_distance;     /* AO: 1 / D for the falloff; 0: none */
  float falloff;              /* AO: the power p; 0: none */
  uint rays_per_point;        /* packets: rays in a row that share their origin */
  /* Packets; set by occlusion_pass() and point_ao_pass(). */
  uint large_batches;          /* of neighbours: the first ones, of DAPPLE_PIXEL_RAY_BATCH rays */
  uint batches_per_ticket;          /* of points: batches that one ticket stands for */
} OcclusionParams;

/* Samples of a sample batch: its mean counts once in the sum of squares that variances come from. At least
   those of one camera ray, as these are correlated. Not two: experiment 517. */
#define DAPPLE_SAMPLE_BATCH 4u

/* A pixel of the crop (row-major) that is to be sampled, and how many samples it has. */
typedef struct PixelWork {
  uint pixel;
  uint first_sample;
} PixelWork;

/* A slice: `pixel_count` entries of the work list from `first_work`, and of each the samples
   from first_sample on, counted from its own; item = entry * sample_count + sample. Samples are
   those of whole camera rays; slices that don't end their pixels' samples are whole batches. */
typedef struct SliceParams {
  uint first_work;
  uint pixel_count;
  uint first_sample;
  uint sample_count;
} SliceParams;

typedef struct CameraParams {
  SliceParams slice;
  SceneParams scene;
  float to_world[12];   /* rows of a 3x4 matrix, column vectors */
  float half_width;     /* of the image plane: at distance 1, or in metres if orthographic */
  float half_height;
  uint orthographic;
  uint width, height;   /* the whole picture, pixels */
  uint crop_x, crop_y;
  uint crop_width;
  uint seed;
  float inverse_spp;    /* 1 / samples a pixel that were asked for */
  float texel_share;    /* of a pixel's area that each look-up in a texture averages; 0: none */
  float tap_offset;      /* as in FilterTaps; 0: no filter taps */
  float tap_centring;       /* how far the taps' centre moves from the hit to the pixel's centre, [0,1] */
  float medium_error;     /* by which the opacity of a medium's box in a pixel may deviate; 0: no media */
  uint splitting_bits;      /* two to these samples in a row share a camera ray */
  /* Pixels in which the scene may be: columns [left, right), rows [above, below). */
  uint seen_left, seen_above, seen_right, seen_below;
} CameraParams;

/* Rays a point for AO; also for points that no camera made. */
typedef struct AoParams {
  uint point_count;     /* points to shoot from: entries of the active list, if there is one */
  uint rays;            /* a point */
  float inverse_count;  /* 1 / (rays asked for to estimate this pixel or point) */
  float t_max;
  uint seed;
  uint whole_sets;      /* a point's rays are all there are for it, its sample being 0: best placed
                           for that number of them */
} AoParams;

typedef struct LightParams {
  uint point_count;
  uint rays;
  float inverse_count;
  uint light;           /* index of the LightRecord */
  uint seed;
} LightParams;

/* Sums over the samples of each pixel into 64-bit fixed point planes. scale values are
   powers of two. */
typedef struct ResolveParams {
  SliceParams slice;
  uint film_pixels;     /* pixels of a plane */
  uint plane;           /* first plane to add to */
  uint rays;            /* rays a sample */
  uint squares;         /* first of two planes of squares to add to */
  uint splitting_bits;      /* as in CameraParams */
  float scale;          /* of unit-range values */
  float position_scale;
  float depth_scale;
  float axis[3];        /* viewing axis, unit */
  float eye[3];
} ResolveParams;

#ifndef __OPENCL_VERSION__
static_assert(DAPPLE_SAMPLE_BATCH % DAPPLE_MAX_CAMERA_SPLITTING == 0, "batches are whole camera rays");
}  // namespace dapple
#endif

#endif
