/* Parameters of the kernels, passed by value: one struct for each pass. The host fills them,
   kernels read them. */
#ifndef DAPPLE_SHARED_PASS_PARAMS_H
#define DAPPLE_SHARED_PASS_PARAMS_H

#include "dapple/shared/language.h"
#include "dapple/shared/ray.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Where a traversal of the scene starts. */
typedef struct SceneParams {
  uint root;    /* index of the root node */
  uint has_top; /* 1: root is top-level; 0: it is the only object's, in world space */
} SceneParams;

/* Rays in a ray batch: they are sorted together and then divided into packets. The maximum for the
   rays of one point; the number for rays of neighbouring pixels; and the number for the small
   batches at the end of a queue of these (experiment 304). */
#define DAPPLE_POINT_RAY_BATCH 512u
#define DAPPLE_PIXEL_RAY_BATCH 1024u
#define DAPPLE_SMALL_RAY_BATCH 256u

/* Rays that a work-item of the vector kernels generates. */
#define DAPPLE_RAY_LANES 16u

/* Work-items of a work-group of order_rays, and the rays that it orders (experiment 755). */
#define DAPPLE_ORDER_GROUP 256u
#define DAPPLE_ORDER_BATCH 4096u

/* Work-items of a work-group that compacts hits. */
#define DAPPLE_SCAN_ITEMS 256u

/* Work-items of each pixel that shade its points on GPUs. */
#define DAPPLE_SHADING_ITEMS 16u

typedef struct OcclusionParams {
  SceneParams scene;
  uint ray_count;
  float footprint;        /* scale, >= 0 */
  float inverse_distance; /* AO: 1 / D for the falloff; 0: none */
  float falloff;          /* AO: the power p; 0: none */
  float roulette;         /* exact rays: c of roulette.clh, [0,1); 0: none */
  uint rays_per_point;    /* packets: consecutive rays that share their origin */
  /* The next two are for packets; occlusion_pass() and point_ao_pass() set them. */
  uint large_batches;      /* pixel packets: number of batches of DAPPLE_PIXEL_RAY_BATCH rays */
  uint batches_per_ticket; /* point packets: consecutive batches of one ticket */
} OcclusionParams;

/* Samples in a sample batch. The squares of the batches' means are summed for the variance
   estimate. A batch contains all samples of a camera ray, since these are correlated. Not two
   samples: experiment 517. */
#define DAPPLE_SAMPLE_BATCH 4u

/* A pixel that is to be sampled (row-major index in the crop), and the number of samples that it
   already has. */
typedef struct PixelWork {
  uint pixel;
  uint first_sample;
} PixelWork;

/* A slice of the work list: `pixel_count` entries from `first_work` on, with `sample_count` samples
   of each. first_sample is relative to PixelWork::first_sample. Item = entry * sample_count +
   sample. A slice has all samples of a camera ray or none. Unless it has the last samples of its
   pixels, it has whole sample batches. */
typedef struct SliceParams {
  uint first_work;
  uint pixel_count;
  uint first_sample;
  uint sample_count;
} SliceParams;

typedef struct CameraParams {
  SliceParams slice;
  SceneParams scene;
  float to_world[12]; /* rows of a 3x4 matrix, column vectors */
  float half_width;   /* of the image plane: at distance 1, or in metres if orthographic */
  float half_height;
  uint orthographic;
  float lens_radius;           /* metres; 0: a pinhole */
  float inverse_focus;         /* 1 / distance along the viewing axis at which points are sharp */
  uint width, height; /* the whole picture, pixels */
  uint crop_x, crop_y;
  uint crop_width;
  uint seed;
  float inverse_spp;   /* 1 / samples a pixel that footprints are computed for */
  float texel_share;   /* part of a pixel's area that a texture lookup averages; 0: none */
  float tap_offset;    /* as FilterTaps::reach; 0: no filter taps */
  float tap_centring;  /* shift of the filter taps from the hit to the pixel's centre, [0,1] */
  float medium_error;  /* allowed deviation of a medium's opacity in a pixel; 0: no media */
  uint splitting_bits; /* log2 of the number of consecutive samples that share a camera ray */
  uint keep_hits;      /* 1: a shading pass follows, see SurfacePoint */
  /* Pixels that may show the scene: columns [left, right), rows [above, below). */
  uint seen_left, seen_above, seen_right, seen_below;
} CameraParams;

/* Where points were seen from. The vector from a point P to there is at - to_points * P: that to the
   middle of the lens, or against the viewing direction of an orthographic camera. */
typedef struct Viewpoint {
  float at[3];     /* world space */
  float to_points; /* 1: perspective; 0: orthographic */
  uint is_known;   /* 0: the points come from a caller, and nothing is known to be free */
} Viewpoint;

/* AO rays from points: those that the camera pass found, or those of a caller. */
typedef struct AoParams {
  uint point_count;    /* entries of the active list; without such a list, points */
  uint rays;           /* for each point */
  float inverse_count; /* 1 / (rays for each pixel or point that footprints are computed for) */
  float t_max;
  uint seed;
  uint whole_sets; /* 1: a point has no other rays, and its sample is 0. The directions are
                      then points of a Vogel spiral of that number of points. */
  uint shaded;     /* 1: the shading pass set SurfacePoint::t */
  Viewpoint viewpoint;
} AoParams;

typedef struct LightParams {
  uint point_count;
  uint rays;
  float inverse_count;
  uint light; /* index of the LightRecord */
  uint seed;
  uint shaded; /* as in AoParams */
  Viewpoint viewpoint;
} LightParams;

/* Adds the samples of each pixel to planes of 64-bit fixed-point numbers. Each scale is a power of
   two. */
typedef struct ResolveParams {
  SliceParams slice;
  uint film_pixels;    /* pixels of a plane */
  uint first_sample;   /* the number of each pixel's first sample */
  uint plane;          /* first plane to add to */
  uint rays;           /* rays a sample */
  uint squares;        /* first of two planes of squares to add to */
  uint backs;          /* 1: of AO and lights only what arrives is added, and no squares; visits to `visits` */
  uint visits;         /* plane of the front's visits, before that of its tests */
  uint albedo;         /* 1: DAPPLE_REFLECTED_PLANES follow */
  uint splitting_bits; /* as in CameraParams */
  float scale;         /* of values in [0,1] */
  float position_scale;
  float depth_scale;
  float axis[3]; /* viewing axis, unit */
  float eye[3];
} ResolveParams;

/* The passes that choose the samples whose backs are traced. */
typedef struct BackParams {
  ResolveParams resolve;
  uint group_bits; /* of each 2^group_bits samples of a pixel one is chosen */
  uint seed;
  uint width; /* of the whole picture, pixels */
  uint crop_x, crop_y, crop_width;
  uint slots;        /* samples of a pixel in the packed slice of turned points */
  uint first_packed; /* where the slice begins there, a multiple of DAPPLE_HIT_BITS */
} BackParams;

/* The shading pass. Its planes: shading normal (3) if there are normals, then albedo (3). */
typedef struct ShadingParams {
  ResolveParams resolve;
  uint normals;       /* 1: there are normals of corners */
  uint albedo;        /* 1: there are colours */
  uint resolves;      /* 0: nothing is added to the film */
  uint segment_words; /* where the words of segments begin, surface_color.h */
  float color_share;  /* part of a pixel that a colour averages, in shares of a sample */
  Viewpoint viewpoint;
} ShadingParams;

#ifndef __OPENCL_VERSION__
static_assert(DAPPLE_SAMPLE_BATCH % DAPPLE_MAX_CAMERA_SPLITTING == 0,
              "batches are whole camera rays");
}  // namespace dapple
#endif

#endif
