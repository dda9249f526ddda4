/* The camera pass: where the slice's camera rays meet the scene, a beam of them an item. */
#include "beam_nearest.clh"
#include "camera.clh"
#include "surface_point.clh"

/* Stores what sample i of the beam met. */
inline void store_hit(Scene scene, const CameraSamples* samples, const BeamRays* rays,
                      const float* area, const BeamNearest* nearest, uint i,
                      __global SurfacePoint* point) {
  const float3 direction = (float3)(((const float*)&rays->direction[0])[i],
                                    ((const float*)&rays->direction[1])[i],
                                    ((const float*)&rays->direction[2])[i]);
  const float3 origin = (float3)(((const float*)&rays->origin[0])[i],
                                 ((const float*)&rays->origin[1])[i],
                                 ((const float*)&rays->origin[2])[i]);
  store_point(scene, nearest_of_ray(nearest, i).hit, origin, direction, area[i], point);
  point->pixel = samples->pixel[i];
  point->sample = samples->sample[i];
}

/* Where the rays of one beam meet the scene: `count` samples of the slice, from `first` on. */
inline CameraBeam trace_beam(Scene scene, CameraParams params, __global const PixelWork* work,
                             const Entries* entries, uint first, uint count,
                             __global SurfacePoint* points) {
  CameraSamples chosen;
  choose_samples(work, params, first, count, &chosen);
  BeamRays rays;
  float16 solid_angle, first_area;
  aim(params, &chosen, &rays, &solid_angle, &first_area);
  BeamNearest nearest;
  for (uint i = 0; i < DAPPLE_BEAM_RAYS; ++i) nearest.t.f[i] = i < count ? INFINITY : 0.0f;
  nearest.u.v = nearest.v.v = (float16)(0.0f);
  nearest.triangle.v = nearest.instance.v = (int16)(0);
  nearest.farthest = INFINITY;
  nearest.visits = nearest.tests = 0u;
  find_nearest(scene, params.scene, entries, &rays, chosen.key, &nearest);
  const uint hits = bits_of_rays((nearest.t.v > 0.0f) & (nearest.t.v < INFINITY));
  BeamFloats area;
  area.v = first_area + solid_angle * nearest.t.v * nearest.t.v;
  for (uint left = hits; left; left &= left - 1u) {
    const uint i = popcount((left & -left) - 1u);
    store_hit(scene, &chosen, &rays, area.f, &nearest, i, points + first + i);
  }
  const CameraBeam found = {hits, 0u, nearest.visits, nearest.tests};
  return found;
}

/* Beams an item, which set out from the nodes that they meet together; kBeamsPerItem in
   host/wavefront/passes.cpp. */
#define DAPPLE_BEAMS_PER_ITEM 4u

/* Points of samples that miss are left as they are. */
__kernel void camera_hits(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const SegmentBlock* segments,
                          __global const TexturedTriangle* textured,
                          __global const MaterialRecord* materials, __global const uchar* texels,
                          __global const InstanceRecord* instances,
                          __global const PixelWork* work, __global SurfacePoint* points,
                          __global CameraBeam* beams, CameraParams params) {
  const uint samples = params.slice.pixel_count * params.slice.sample_count;
  const uint begin = get_global_id(0) * DAPPLE_BEAMS_PER_ITEM * DAPPLE_BEAM_RAYS;
  if (begin >= samples) return;
  const uint end = min(begin + DAPPLE_BEAMS_PER_ITEM * DAPPLE_BEAM_RAYS, samples);
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  BeamBounds bounds;
  bound_samples(work, params, begin, end - begin, &bounds);
  Entries entries;
  find_entries(scene, params.scene, &bounds, &entries);
  for (uint first = begin; first < end; first += DAPPLE_BEAM_RAYS) {
    CameraBeam found = {0u, 0u, 0u, 0u};
    if (entries.count) {
      const uint count = min(end - first, DAPPLE_BEAM_RAYS);
      found = trace_beam(scene, params, work, &entries, first, count, points);
    }
    found.visits += first == begin ? entries.visits : 0u;
    beams[first / DAPPLE_BEAM_RAYS] = found;
  }
}
