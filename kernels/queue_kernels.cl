/* The small kernels between the traversal kernels: ray generation, compaction and resolve. They are one
   program, since each program costs compile time: experiment 713. Kernels of dome lights are a program
   of their own (lights/dome.cl), as few scenes need them. */
#include "occlusion/ao.cl"
#include "occlusion/gather.cl"
#include "occlusion/ray_sums.cl"
#include "film/backs.cl"
#include "film/compact.cl"
#include "film/film.cl"
#include "lights/light.cl"
