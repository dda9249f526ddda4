/* Parts of the camera pass and of resolving as kernels. */
#include "camera_samples.clh"
#include "film.clh"

/* The order in which one item takes its samples, by their places in the picture. */
__kernel void camera_order(__global const float* x, __global const float* y,
                           __global uint* order) {
  if (get_global_id(0) > 0) return;
  CameraSamples samples, sorted;
  for (uint i = 0; i < DAPPLE_ITEM_RAYS; ++i) {
    samples.x[i] = x[i];
    samples.y[i] = y[i];
    samples.place[i] = i;
    samples.pixel[i] = samples.sample[i] = 0u;
    samples.threshold[0][i] = 0.0f;
  }
  sort_samples(&samples, 1u, &sorted);
  for (uint i = 0; i < DAPPLE_ITEM_RAYS; ++i) order[i] = sorted.place[i];
}

/* Eight values an item, scaled already. */
__kernel void to_fixed_points(__global const float* values, __global long* sums, uint count) {
  const uint item = get_global_id(0);
  if (item < count) vstore8(fixed_points(vload8(item, values)), item, sums);
}
