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
  store_point(scene, nearest_of_ray(nearest, i).hit, direction, area[i], point);
  point->pixel = samples->pixel[i];
  point->sample = samples->sample[i];
}

/* Points of samples that miss are left as they are. */
__kernel void camera_hits(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const TexturedTriangle* textured,
                          __global const TextureRecord* textures, __global const uchar* texels,
                          __global const InstanceRecord* instances,
                          __global const PixelWork* work, __global SurfacePoint* points,
                          __global CameraBeam* beams, CameraParams params) {
  const uint samples = params.slice.pixel_count * params.slice.sample_count;
  const uint first = get_global_id(0) * DAPPLE_BEAM_RAYS;
  if (first >= samples) return;
  const Scene scene = {nodes, blocks, textured, textures, texels, instances};
  const uint count = min(samples - first, DAPPLE_BEAM_RAYS);
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
  find_nearest(scene, params.scene, &rays, chosen.key, &nearest);
  const uint hits = bits_of_rays((nearest.t.v > 0.0f) & (nearest.t.v < INFINITY));
  BeamFloats area;
  area.v = first_area + solid_angle * nearest.t.v * nearest.t.v;
  for (uint left = hits; left; left &= left - 1u) {
    const uint i = popcount((left & -left) - 1u);
    store_hit(scene, &chosen, &rays, area.f, &nearest, i, points + first + i);
  }
  const CameraBeam found = {hits, 0u, nearest.visits, nearest.tests};
  beams[get_global_id(0)] = found;
}
