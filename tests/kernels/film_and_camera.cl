/* Functions of the camera pass and of resolving, called by kernels for the tests. */
#include "camera/camera.clh"
#include "camera/surface_points16.clh"
#include "film/film.clh"

/* Rounds to fixed point: eight values an item, already scaled. */
__kernel void to_fixed_points(__global const float* values, __global long* sums, uint count) {
  const uint item = get_global_id(0);
  if (item < count) vstore8(fixed_points(vload8(item, values)), item, sums);
}

/* In: sixteen rays, seven numbers each (origin, direction, t), and the primitives that they hit.
   Out: the hit points, seven numbers each (position, normal, offset), computed for all rays at once
   (together) and one by one (alone). */
__kernel void placed_points(__global const TriangleBlock* blocks,
                            __global const SegmentBlock* segments,
                            __global const InstanceRecord* instances, __global const float* rays,
                            __global const uint* primitives, __global const uint* placements,
                            __global float* together, __global float* alone) {
  if (get_global_id(0) > 0) return;
  const Scene scene = {0, blocks, segments, 0, 0, 0, instances};
  Rays16 group;
  StochasticHits stops;
  for (uint i = 0; i < DAPPLE_GROUP_RAYS; ++i) {
    for (uint axis = 0; axis < 3u; ++axis) {
      ((float*)(group.origin + axis))[i] = rays[7u * i + axis];
      ((float*)(group.direction + axis))[i] = rays[7u * i + 3u + axis];
    }
    stops.t[0].f[i] = rays[7u * i + 6u];
    stops.primitive[0].i[i] = (int)primitives[i];
    stops.instance[0].i[i] = (int)placements[i];
  }
  SurfacePoints16 at;
  clear_points(&at);
  const uint keys[DAPPLE_GROUP_RAYS] = {0};
  store_hit_points(scene, &group, keys, &stops, 0u, 65535u, &at);
  for (uint i = 0; i < DAPPLE_GROUP_RAYS; ++i) {
    const float3 origin = vload3(0, rays + 7u * i), direction = vload3(0, rays + 7u * i + 3u);
    const SurfaceHit hit = {rays[7u * i + 6u], primitives[i], placements[i]};
    const WorldPoint point = point_of_hit(scene, hit, origin, direction);
    float3 normal = normalize(point.normal);
    if (dot(normal, direction) > 0.0f) normal = -normal;
    vstore3(point.position, 0, alone + 7u * i);
    vstore3(normal, 0, alone + 7u * i + 3u);
    alone[7u * i + 6u] = point.offset;
    for (uint axis = 0; axis < 3u; ++axis) {
      together[7u * i + axis] = at.position[axis].f[i];
      together[7u * i + 3u + axis] = at.normal[axis].f[i];
    }
    together[7u * i + 6u] = at.offset.f[i];
  }
}

/* Out: solid angles of the pixels' shares for rays through their centres, sixteen an item. */
__kernel void pixel_solid_angles(__global float* solid_angles, CameraParams params, uint count) {
  const uint first = get_global_id(0) * DAPPLE_GROUP_RAYS;
  if (first >= count) return;
  CameraSamples chosen;
  for (uint i = 0; i < DAPPLE_GROUP_RAYS; ++i) {
    const uint pixel = first + i;
    chosen.pixel[i] = pixel;
    chosen.sample[i] = 0u;
    chosen.x[i] = (float)(pixel % params.width) + 0.5f;
    chosen.y[i] = (float)(pixel / params.width) + 0.5f;
  }
  FilterTaps taps;
  Rays16 rays;
  CameraShares16 shares;
  uint keys[DAPPLE_GROUP_RAYS];
  aim(params, &chosen, 0u, &taps, &rays, &shares, keys);
  vstore16(shares.solid_angle.v, 0, solid_angles + first);
}
