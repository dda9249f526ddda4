/* The order of planes in the film's sums, which the kernels of kernels/film and kernels/lights write and
   host/film reads: planes of the surface, which every picture has at its beginning, and those of a pass,
   from its first one on. FilmLayout (host/film/sums/film_sums.hpp) knows where each pass begins. */
#ifndef DAPPLE_SHARED_FILM_PLANES_H
#define DAPPLE_SHARED_FILM_PLANES_H

/* Of the surface: samples that hit, their geometric normals (3), positions (3) and depth. The shading normal
   has planes of its own. */
#define DAPPLE_PLANE_HITS 0u
#define DAPPLE_PLANE_NORMAL 1u
#define DAPPLE_PLANE_POSITION 4u
#define DAPPLE_PLANE_DEPTH 7u
#define DAPPLE_PLANE_CAMERA_VISITS 8u /* of nodes */
#define DAPPLE_PLANE_CAMERA_TESTS 9u  /* of triangles and segments */
#define DAPPLE_SURFACE_PLANES 10u

/* Of AO: transmittance, unoccluded directions (3), visits, tests. Backs have the first one alone; their visits
   and tests count among those of the front, here and of lights. */
#define DAPPLE_PLANE_AO_BENT 1u
#define DAPPLE_PLANE_AO_VISITS 4u /* and tests */
#define DAPPLE_AO_PLANES 6u

/* Of a light: irradiance, the same without occlusion, visits, tests; irradiances of a dome have 3 channels.
   Backs have the first irradiance alone. */
#define DAPPLE_LIGHT_PLANES 4u
#define DAPPLE_DOME_PLANES 8u
#define DAPPLE_DOME_CHANNELS 3u

/* After those of AO, and of each light: the transmittance or irradiance of each sample times its albedo, in red,
   green and blue. Pictures with albedo have them, backs do not. */
#define DAPPLE_REFLECTED_PLANES 3u

/* Of backs, before those of their passes: samples that began at a back, and those that hit something. Of
   shading normals and of albedo, which not every picture has. */
#define DAPPLE_PLANE_BACK_CHOSEN 0u
#define DAPPLE_PLANE_BACK_HITS 1u
#define DAPPLE_BACK_PLANES 2u
#define DAPPLE_NORMAL_PLANES 3u
#define DAPPLE_ALBEDO_PLANES 3u

#endif
