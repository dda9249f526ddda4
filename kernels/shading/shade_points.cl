/* The shading pass: adds shading normals and colours to the surface points of a slice. In: points
   that the camera pass stored with their triangles, after resolve_surface. Out: points moved to
   where their rays start; sums of normals and albedo in the film. One work-item for each pixel, or
   for each record of samples where nothing is added to the film. */
#include "shading/shading_normal.clh"
#include "shading/surface_color.clh"
#include "film/film.clh"
#include "shading/shading.clh"

/* What a group of points hit, and lanes of it. */
typedef struct HitGroup {
  Hits16 hits;
  CornerWords16 words;
  ColorEntries16 entries;
  uint in_media; /* hit a medium; its triangle stands for it */
  uint smooth;   /* have normals */
  uint located;  /* need barycentrics */
} HitGroup;

/* Takes the hits from the points in `lanes`, whose `t` and `visits` become 0. */
inline void take_hits(Scene scene, const Shading* shading, uint lanes,
                      __global SurfacePoint* points, HitGroup* group) {
  group->in_media = group->smooth = group->located = 0u;
  group->words.first.v = group->words.last.v = (uint16)(0u);
  for (uint left = lanes; left; left &= left - 1u) {
    const uint lane = lowest_bit(left), bit = 1u << lane;
    uint instance = as_uint(points[lane].t), primitive = points[lane].visits;
    points[lane].t = 0.0f;
    points[lane].visits = 0u;
    if (is_medium_hit(instance)) {
      group->in_media |= bit;
      instance ^= DAPPLE_IN_MEDIUM;
      primitive = triangle_in_medium(scene, primitive,
                                     hash_pair(points[lane].pixel, points[lane].sample));
    }
    group->hits.instance[lane] = instance;
    group->hits.primitive[lane] = primitive;
    const bool is_triangle = !(primitive & DAPPLE_SEGMENTS);
    if (shading->has_normals && is_triangle && !(group->in_media & bit)) {
      const CornerNormals packed = normals_of(shading->normals, primitive);
      group->words.first.u[lane] = packed.words[0];
      group->words.last.u[lane] = packed.words[1];
      group->smooth |= packed.words[0] ? bit : 0u;
    }
    if (!shading->has_colors) continue;
    group->entries.entry[lane] = color_entry(shading->colors, primitive);
    const bool varies = (group->entries.entry[lane][0] & ~DAPPLE_COLOR_MATERIAL) != 0u;
    group->located |= is_triangle && varies ? bit : 0u;
  }
  group->located |= group->smooth;
}

/* A random point of a triangle that stands for a medium. */
inline void place_in_media(uint in_media, __global const SurfacePoint* points, HitTriangles16* of) {
  for (uint left = in_media; left; left &= left - 1u) {
    const uint lane = lowest_bit(left);
    const float2 at = random_barycentrics(hash_pair(points[lane].sample, points[lane].pixel));
    of->u.f[lane] = at.x;
    of->v.f[lane] = at.y;
  }
}

/* Shades the points in `lanes`, at least one, and sets their albedos. */
inline void shade_group(Scene scene, const Shading* shading, uint lanes,
                        __global SurfacePoint* points, Floats16* albedo) {
  HitGroup group;
  HitTriangles16 triangles;
  take_hits(scene, shading, lanes, points, &group);
  triangles.u.v = triangles.v.v = (float16)(0.0f);
  if (group.located) {
    load_hit_triangles(scene, &group.hits, points, group.located, &triangles);
    place_in_media(group.in_media & group.located, points, &triangles);
  }
  if (shading->has_colors) {
    surface_colors(scene, shading->colors, &group.hits, &group.entries, points, lanes,
                   &triangles.u, &triangles.v, albedo);
  }
  if (group.smooth)
    shade_points16(scene, &group.hits, &triangles, &group.words, group.smooth, shading->viewpoint,
                   points);
}

/* Planes: shading normal (3), if there are any; albedo (3), if it is requested, which `albedos` gets for each
   sample, too. */
__kernel void shade_points(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                           __global const TexturedTriangle* textured,
                           __global const InstanceRecord* instances,
                           __global const CornerNormals* normals, __global const uint* color_words,
                           __global const ColorMaterial* color_materials,
                           __global const uint* color_texels, __global const PixelWork* work,
                           __global SurfacePoint* points, __global const SampleHits* sample_hits,
                           __global SampleAlbedo* albedos, __global long* film, ShadingParams params) {
  const uint local_pixel = get_global_id(0);
  const SliceParams slice = params.resolve.slice;
  if (local_pixel >= slice.pixel_count) return;
  const Scene scene = {nodes, blocks, 0, textured, 0, 0, instances};
  const Shading shading = {normals,
                           {color_words, color_materials, color_texels, params.segment_words,
                            params.color_share},
                           params.normals != 0u, params.albedo != 0u, params.viewpoint};
  const uint begin = local_pixel * slice.sample_count, end = begin + slice.sample_count;
  long8 sums = (long8)(0);
  bool any = false;
  for (uint r = begin / DAPPLE_HIT_BITS; r * DAPPLE_HIT_BITS < end; ++r) {
    const uint lanes = sample_hits[r].hits & range_of_samples(r, begin, end);
    if (!lanes) continue;
    any = true;
    __global SurfacePoint* of_record = points + r * DAPPLE_HIT_BITS;
    Floats16 albedo[3];
    albedo[0].v = albedo[1].v = albedo[2].v = (float16)(0.0f);
    shade_group(scene, &shading, lanes, of_record, albedo);
    if (!params.resolves) continue;
    for (uint left = lanes; left; left &= left - 1u) {
      const uint lane = lowest_bit(left);
      const float3 n = load3(of_record[lane].normal);
      if (shading.has_colors)
        store3(albedos[r * DAPPLE_HIT_BITS + lane].color,
               (float3)(albedo[0].f[lane], albedo[1].f[lane], albedo[2].f[lane]));
      sums += fixed_points((float8)(n.x, n.y, n.z, albedo[0].f[lane], albedo[1].f[lane],
                                    albedo[2].f[lane], 0.0f, 0.0f) *
                           params.resolve.scale);
    }
  }
  if (!any || !params.resolves) return;
  const FilmPixel pixel = film_pixel(work, params.resolve, local_pixel);
  uint plane = 0u;
  if (shading.has_normals) {
    add_to_planes(film, params.resolve, DAPPLE_NORMAL_PLANES, pixel, sums);
    plane = DAPPLE_NORMAL_PLANES;
  }
  if (shading.has_colors) add_color(film, params.resolve, plane, pixel, sums.s34534534);
}
