/* The shading pass for GPUs: each work-item shades every sixteenth sample of a pixel. In and out: as
   shading/shade_points.cl. A work-group has four pixels, and adds up what its items found. */
#include "film/film.clh"
#include "shading/shading.clh"
#include "camera/medium_surface.clh"
#include "shading/smooth_triangle_scalar.clh"
#include "shading/surface_color_scalar.clh"

#define DAPPLE_SHADING_PIXELS 4u /* of a work-group */
#define DAPPLE_SHADING_GROUP (DAPPLE_SHADING_ITEMS * DAPPLE_SHADING_PIXELS)
#define DAPPLE_SHADED_PLANES (DAPPLE_NORMAL_PLANES + DAPPLE_ALBEDO_PLANES)

/* Gives a point that the camera pass stored its shading normal and origin of rays. Out: its albedo. */
DAPPLE_INLINE float3 shade_hit(Scene scene, const Shading* shading, __global SurfacePoint* point) {
  uint instance = as_uint(point->t), primitive = point->visits;
  point->t = 0.0f;
  point->visits = 0u;
  const bool in_medium = is_medium_hit(instance);
  if (in_medium) {
    instance ^= DAPPLE_IN_MEDIUM;
    primitive = triangle_in_medium(scene, primitive, hash_pair(point->pixel, point->sample));
  }
  HitTriangle triangle;
  triangle.at = (float2)(0.0f);
  const bool is_triangle = !(primitive & DAPPLE_SEGMENTS);
  if (is_triangle) triangle = load_hit_triangle(scene, primitive, instance, load3(point->position));
  if (in_medium) triangle.at = random_barycentrics(hash_pair(point->sample, point->pixel));
  if (shading->has_normals && is_triangle && !in_medium) {
    const CornerNormals normals = normals_of(shading->normals, primitive);
    if (normals.words[0]) shade_point(scene, smooth_point(&triangle, normals), instance, shading->viewpoint, point);
  }
  if (!shading->has_colors) return (float3)(0.0f);
  return surface_color(scene, shading->colors, primitive, instance, triangle.at, point->area);
}

/* Normals and albedos in fixed point, of the samples of `of_pixel` that this item has, whose `albedos` it sets. */
DAPPLE_INLINE long8 shade_samples(Scene scene, const Shading* shading, ResolveParams params, uint of_pixel,
                                  __global const SampleHits* sample_hits, __global SurfacePoint* points,
                                  __global SampleAlbedo* albedos) {
  const uint begin = of_pixel * params.slice.sample_count, end = begin + params.slice.sample_count;
  long8 sums = (long8)(0);
  for (uint s = begin + get_local_id(0) % DAPPLE_SHADING_ITEMS; s < end; s += DAPPLE_SHADING_ITEMS) {
    if (!sample_hit(sample_hits, s)) continue;
    const float3 albedo = shade_hit(scene, shading, points + s), n = load3(points[s].normal);
    if (shading->has_colors) store3(albedos[s].color, albedo);
    sums += fixed_points((float8)(n.x, n.y, n.z, albedo.x, albedo.y, albedo.z, 0.0f, 0.0f) * params.scale);
  }
  return sums;
}

/* Planes: as shade_points. */
__kernel __attribute__((reqd_work_group_size(DAPPLE_SHADING_GROUP, 1, 1)))
void shade_points_scalar(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                         __global const TexturedTriangle* textured, __global const InstanceRecord* instances,
                         __global const CornerNormals* normals, __global const uint* color_words,
                         __global const ColorMaterial* color_materials, __global const uint* color_texels,
                         __global const PixelWork* work, __global SurfacePoint* points,
                         __global const SampleHits* sample_hits, __global SampleAlbedo* albedos,
                         __global long* film, ShadingParams params) {
  __local long sums[DAPPLE_SHADING_GROUP * DAPPLE_SHADED_PLANES];
  const uint in_group = get_local_id(0), first = get_group_id(0) * DAPPLE_SHADING_PIXELS;
  const Scene scene = {nodes, blocks, 0, textured, 0, 0, instances};
  const Shading shading = {normals,
                           {color_words, color_materials, color_texels, params.segment_words, params.color_share},
                           params.normals != 0u, params.albedo != 0u, params.viewpoint};
  const uint own_pixel = first + in_group / DAPPLE_SHADING_ITEMS;
  PlaneSums own;
  own.v = (long8)(0);
  if (own_pixel < params.resolve.slice.pixel_count)
    own.v = shade_samples(scene, &shading, params.resolve, own_pixel, sample_hits, points, albedos);
  for (uint plane = 0; plane < DAPPLE_SHADED_PLANES; ++plane)
    sums[in_group * DAPPLE_SHADED_PLANES + plane] = own.plane[plane];
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint pixel = first + in_group / DAPPLE_SHADED_PLANES, plane = in_group % DAPPLE_SHADED_PLANES;
  if (!params.resolves || in_group >= DAPPLE_SHADING_PIXELS * DAPPLE_SHADED_PLANES) return;
  if (pixel >= params.resolve.slice.pixel_count) return;
  const bool of_color = plane >= DAPPLE_NORMAL_PLANES;
  if (of_color ? !shading.has_colors : !shading.has_normals) return;
  long sum = 0;
  const uint items = in_group / DAPPLE_SHADED_PLANES * DAPPLE_SHADING_ITEMS;
  for (uint i = 0; i < DAPPLE_SHADING_ITEMS; ++i) sum += sums[(items + i) * DAPPLE_SHADED_PLANES + plane];
  if (sum)
    add_to_plane(film, params.resolve, of_color && !shading.has_normals ? plane - DAPPLE_NORMAL_PLANES : plane,
                 film_pixel(work, params.resolve, pixel), sum);
}
