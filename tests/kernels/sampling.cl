/* Functions of random.clh, direction.clh and the light samplers, called by kernels for the tests.
   One item makes one sample. */
#include "lights/light.cl"

inline float2 sample_2d(uint pixel, uint index, uint pair, uint seed) {
  float x, y;
  sample_square(pixel, index, pair, seed, &x, &y);
  return (float2)(x, y);
}

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

__kernel void vogel_points(__global float* disk, float jitter, uint turn, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  float x, y;
  vogel_disk(item, 1.0f / count, jitter, turn, &x, &y);
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

/* The same by make_frames(); each item uses the next lane. */
__kernel void lane_frames(__global const float* normals, __global float* tangents,
                          __global float* bitangents, uint count) {
  const uint item = get_global_id(0), lane = item % 16u;
  if (item >= count) return;
  Floats16 normal[3], tangent[3], bitangent[3];
  float16 along[3], across[3];
  for (uint axis = 0; axis < 3u; ++axis) {
    normal[axis].v = (float16)(axis == 2u ? 1.0f : 0.0f);
    normal[axis].f[lane] = normals[3u * item + axis];
  }
  make_frames(normal[0].v, normal[1].v, normal[2].v, along, across);
  for (uint axis = 0; axis < 3u; ++axis) {
    tangent[axis].v = along[axis];
    bitangent[axis].v = across[axis];
    tangents[3u * item + axis] = tangent[axis].f[lane];
    bitangents[3u * item + axis] = bitangent[axis].f[lane];
  }
}

/* Each item uses the next of sixteen lanes. */
__kernel void cone_directions(__global const float* squares, __global const float* axes,
                              __global float* directions, float one_minus_cos, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const uint lane = item % DAPPLE_RAY_LANES;
  PointRays rays;
  Floats16 axis[3];
  LightSamples samples;
  for (uint i = 0; i < 3u; ++i) {
    axis[i].v = (float16)(i == 2u ? 1.0f : 0.0f);
    axis[i].f[lane] = axes[3u * item + i];
  }
  rays.u.v = rays.v.v = (float16)(0.5f);
  rays.u.f[lane] = squares[2u * item];
  rays.v.f[lane] = squares[2u * item + 1u];
  const float16 along[3] = {axis[0].v, axis[1].v, axis[2].v};
  sample_cones(along, (float16)(one_minus_cos), &rays, &samples);
  vstore3((float3)(samples.direction[0].f[lane], samples.direction[1].f[lane],
                   samples.direction[2].f[lane]),
          item, directions);
}

/* Direction, distance and solid angle of `count` samples of a light seen from the origin, normal +Y. Each item
   uses the next of sixteen lanes. */
__kernel void light_samples(__global const LightRecord* lights,
                            __global const EmitterTriangle* emitters, __global float* directions,
                            __global float* distances, __global float* solid_angles, uint light,
                            uint count) {
  const uint item = get_global_id(0), lane = item % DAPPLE_RAY_LANES;
  if (item >= count) return;
  const float2 u = sample_2d(0, item, DAPPLE_PAIR_LIGHT, 1);
  PointRays rays;
  LightSamples samples;
  for (uint axis = 0; axis < 3u; ++axis) {
    rays.origin[axis].v = (float16)(0.0f);
    rays.normal[axis].v = (float16)(axis == 1u ? 1.0f : 0.0f);
  }
  rays.u.v = rays.v.v = (float16)(0.5f);
  rays.u.f[lane] = u.x;
  rays.v.f[lane] = u.y;
  sample_light(lights + light, emitters, 0, &rays, &samples);
  vstore3((float3)(samples.direction[0].f[lane], samples.direction[1].f[lane],
                   samples.direction[2].f[lane]),
          item, directions);
  distances[item] = samples.distance.f[lane];
  solid_angles[item] = samples.solid_angle.f[lane];
}

/* In: points of the plane; out: their angles in turns. */
__kernel void angles(__global const float* points, __global float* turns, uint count) {
  const uint item = get_global_id(0);
  if (item < count) turns[item] = turns_of(points[2u * item + 1u], points[2u * item]);
}

/* In: `share_count` ascending values, the last is 1; out: the step that each number falls into, and the
   position within it. */
__kernel void shares(__global const float* ascending, __global const float* numbers,
                     __global float* places, uint share_count, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  float within = numbers[item];
  const uint step = find_share(ascending, share_count, &within);
  vstore2((float2)((float)step, within), item, places);
}

/* Solid angles of rays from `origin`, 1 steradian before, after limit_near_view_ray(). Each item uses the
   next of sixteen lanes. */
__kernel void clear_of_view(__global const float* directions, __global const float* origin,
                            Viewpoint from, __global float* solid_angles, uint count) {
  const uint item = get_global_id(0), lane = item % DAPPLE_RAY_LANES;
  if (item >= count) return;
  PointRays rays;
  RayDirections aimed;
  for (uint axis = 0; axis < 3u; ++axis) {
    rays.origin[axis].v = (float16)(0.0f);
    rays.origin[axis].f[lane] = origin[axis];
    aimed.direction[axis].v = (float16)(axis == 2u ? 1.0f : 0.0f);
    aimed.direction[axis].f[lane] = directions[3u * item + axis];
  }
  aimed.solid_angle.v = (float16)(1.0f);
  limit_near_view_ray(&rays, from, &aimed);
  solid_angles[item] = aimed.solid_angle.f[lane];
}
