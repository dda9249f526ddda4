/* The kernels around those that trace, compiled together: each program takes a fifth of a
   second on PoCL for OpenCL's own header. Domes, which few scenes have, are apart. */
#include "occlusion/ao.cl"
#include "film/compact.cl"
#include "film/film.cl"
#include "lights/light.cl"
