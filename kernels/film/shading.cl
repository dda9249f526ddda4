/* The shading pass: gives the surface points of a slice what their meshes say about the surface, and adds
   that to the film. In: points that the camera pass stored with their triangles, after resolve_surface. Out:
   points as rays start from them, film sums. One work-item for each pixel. */
#include "camera/shading_normal.clh"
#include "film/film.clh"

/* Planes: shading normal (3). */
__kernel void shade_points(__global const TriangleBlock* blocks,
                           __global const InstanceRecord* instances,
                           __global const CornerNormals* normals, __global const PixelWork* work,
                           __global SurfacePoint* points, __global const SampleHits* sample_hits,
                           __global long* film, ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const Scene scene = {0, blocks, 0, 0, 0, 0, instances};
  const uint begin = local_pixel * params.slice.sample_count;
  const uint end = begin + params.slice.sample_count;
  long8 sums = (long8)(0);
  bool any = false;
  for (uint r = begin / DAPPLE_HIT_BITS; r * DAPPLE_HIT_BITS < end; ++r) {
    const uint lanes = sample_hits[r].hits & range_of_samples(r, begin, end);
    if (!lanes) continue;
    any = true;
    __global SurfacePoint* of_record = points + r * DAPPLE_HIT_BITS;
    shade_points16(scene, normals, lanes, of_record);
    for (uint left = lanes; left; left &= left - 1u) {
      const float3 n = load3(of_record[lowest_bit(left)].normal) * params.scale;
      sums += fixed_points((float8)(n.x, n.y, n.z, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f));
    }
  }
  if (any) add_to_planes(film, params, 3u, pixel_of(work, params, local_pixel), sums);
}
