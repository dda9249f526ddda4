/* The camera pass: a ray through a stratified place in its pixel (box filter). */
#include "pass_params.h"
#include "random.clh"
#include "scene.clh"

__kernel void camera_rays(__global const PixelWork* work, __global Ray* rays,
                          __global SurfacePoint* points, CameraParams params) {
  const uint item = get_global_id(0);
  const SliceParams slice = params.slice;
  if (item >= slice.pixel_count * slice.sample_count) return;
  const PixelWork entry = work[slice.first_work + item / slice.sample_count];
  const uint crop_pixel = entry.pixel;
  const uint sample = entry.first_sample + slice.first_sample + item % slice.sample_count;
  const uint column = params.crop_x + crop_pixel % params.crop_width;
  const uint row = params.crop_y + crop_pixel / params.crop_width;
  const uint pixel = row * params.width + column;
  const float2 jitter = sample_2d(pixel, sample, DAPPLE_PAIR_PIXEL, params.seed);
  const float x = (2.0f * (column + jitter.x) / params.width - 1.0f) * params.half_width;
  const float y = (1.0f - 2.0f * (row + jitter.y) / params.height) * params.half_height;
  const float pixel_area = 4.0f * params.half_width * params.half_height /
                           ((float)params.width * (float)params.height) * params.inverse_spp;
  const float* m = params.to_world;
  float3 origin = (float3)(m[3], m[7], m[11]);
  float3 direction = (float3)(-m[2], -m[6], -m[10]);
  float solid_angle = 0.0f, first_area = 0.0f;
  const float3 aside = x * (float3)(m[0], m[4], m[8]) + y * (float3)(m[1], m[5], m[9]);
  if (params.orthographic) {
    origin += aside;
    first_area = pixel_area;
  } else {
    direction += aside;
    const float stretch = rsqrt(dot(direction, direction));
    solid_angle = pixel_area * stretch * stretch * stretch;
  }
  direction = normalize(direction);
  __global Ray* ray = rays + item;
  store3(ray->origin, origin);
  store3(ray->direction, direction);
  ray->t_max = INFINITY;
  ray->solid_angle = solid_angle;
  ray->first_area = first_area;
  ray->light = 0;
  ray->weight = 1.0f;
  ray->key = hash_pair(hash_pair(pixel, sample), params.seed);
  points[item].pixel = pixel;
  points[item].sample = sample;
}
