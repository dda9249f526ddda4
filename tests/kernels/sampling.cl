/* random.clh, direction.clh and the light samplers as kernels: one item, one sample. */
#include "light.cl"

__kernel void sobol_points(__global float* points, uint pixel, uint pair, uint seed, uint first,
                           uint count) {
  const uint item = get_global_id(0);
  if (item < count) vstore2(sample_2d(pixel, first + item, pair, seed), item, points);
}

__kernel void disk_points(__global const float* squares, __global float* disk, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const float2 square = vload2(item, squares);
  float x, y;
  concentric_disk(square.x, square.y, &x, &y);
  vstore2((float2)(x, y), item, disk);
}

__kernel void sunflower_points(__global float* disk, float jitter, uint turn, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  float x, y;
  sunflower_disk(item, 1.0f / count, jitter, turn, &x, &y);
  vstore2((float2)(x, y), item, disk);
}

__kernel void frames(__global const float* normals, __global float* tangents,
                     __global float* bitangents, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  float3 tangent, bitangent;
  make_frame(vload3(item, normals), &tangent, &bitangent);
  vstore3(tangent, item, tangents);
  vstore3(bitangent, item, bitangents);
}

__kernel void cone_directions(__global const float* squares, __global const float* axes,
                              __global float* directions, float one_minus_cos, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  vstore3(sample_cone(vload3(item, axes), one_minus_cos, vload2(item, squares)), item, directions);
}

/* Direction, distance and solid angle of `count` samples of a light seen from the origin. */
__kernel void light_samples(__global const LightRecord* lights,
                            __global const EmitterTriangle* emitters, __global float* directions,
                            __global float* distances, __global float* solid_angles, uint light,
                            uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const float2 u = sample_2d(0, item, DAPPLE_PAIR_LIGHT, 1);
  const LightSample sample = sample_source(lights + light, emitters, (float3)(0.0f), u);
  vstore3(sample.direction, item, directions);
  distances[item] = sample.distance;
  solid_angles[item] = sample.solid_angle;
}
