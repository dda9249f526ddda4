/* The small kernels between the traversal kernels: ray generation, compaction, resolve. They are one program,
   since every program costs compile time (experiment 713). Domes, which few scenes have, are apart. */
#include "occlusion/ao.cl"
#include "film/compact.cl"
#include "film/film.cl"
#include "lights/light.cl"
