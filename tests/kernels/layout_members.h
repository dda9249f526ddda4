/* Lists every struct that is shared with the device and all its members, for both languages.
   tests/device/layout_test.cpp fails if a member is missing here, because sizes do not add up. */
#ifndef DAPPLE_LAYOUT_MEMBERS_H
#define DAPPLE_LAYOUT_MEMBERS_H

/* clang-format off */
#define DAPPLE_LAYOUT(STRUCT, MEMBER)                                                        \
  STRUCT(BvhNode)                                                                            \
  MEMBER(BvhNode, origin) MEMBER(BvhNode, exponent) MEMBER(BvhNode, inner_mask)              \
  MEMBER(BvhNode, child_base) MEMBER(BvhNode, prim_base) MEMBER(BvhNode, lower)              \
  MEMBER(BvhNode, upper) MEMBER(BvhNode, depth) MEMBER(BvhNode, leaf_end)                    \
  MEMBER(BvhNode, correlation)                                                               \
  STRUCT(TriangleBlock)                                                                      \
  MEMBER(TriangleBlock, vertex) MEMBER(TriangleBlock, opacity)                               \
  STRUCT(SegmentBlock)                                                                       \
  MEMBER(SegmentBlock, origin) MEMBER(SegmentBlock, exponent)                                \
  MEMBER(SegmentBlock, begin_caps) MEMBER(SegmentBlock, end_caps)                            \
  MEMBER(SegmentBlock, spare) MEMBER(SegmentBlock, radius) MEMBER(SegmentBlock, opacity)     \
  MEMBER(SegmentBlock, begin) MEMBER(SegmentBlock, end) MEMBER(SegmentBlock, begin_plane)    \
  MEMBER(SegmentBlock, end_plane) MEMBER(SegmentBlock, begin_radius)                         \
  MEMBER(SegmentBlock, end_radius) MEMBER(SegmentBlock, opacity_code)                        \
  STRUCT(TexturedTriangle)                                                                   \
  MEMBER(TexturedTriangle, corner)                                                           \
  STRUCT(CornerNormals) MEMBER(CornerNormals, words)                                         \
  STRUCT(TextureRecord)                                                                      \
  MEMBER(TextureRecord, offset) MEMBER(TextureRecord, width) MEMBER(TextureRecord, height)   \
  MEMBER(TextureRecord, flags)                                                               \
  STRUCT(MaterialRecord)                                                                     \
  MEMBER(MaterialRecord, texture) MEMBER(MaterialRecord, alpha)                              \
  MEMBER(MaterialRecord, cutoff) MEMBER(MaterialRecord, mips)                                \
  MEMBER(MaterialRecord, spare) MEMBER(MaterialRecord, mip_offset)                           \
  STRUCT(InstanceRecord)                                                                     \
  MEMBER(InstanceRecord, to_object) MEMBER(InstanceRecord, to_world)                         \
  MEMBER(InstanceRecord, inverse_det) MEMBER(InstanceRecord, root)                           \
  MEMBER(InstanceRecord, light) MEMBER(InstanceRecord, source)                                \
  STRUCT(Ray)                                                                                \
  MEMBER(Ray, origin) MEMBER(Ray, t_max) MEMBER(Ray, direction) MEMBER(Ray, solid_angle)     \
  MEMBER(Ray, first_area) MEMBER(Ray, light) MEMBER(Ray, weight) MEMBER(Ray, key)            \
  STRUCT(Occlusion)                                                                          \
  MEMBER(Occlusion, transmittance) MEMBER(Occlusion, visits)                                 \
  STRUCT(RaySums)                                                                            \
  MEMBER(RaySums, weight) MEMBER(RaySums, seen) MEMBER(RaySums, direction)                   \
  STRUCT(SampleHits)                                                                         \
  MEMBER(SampleHits, hits) MEMBER(SampleHits, first_slot)                                    \
  MEMBER(SampleHits, visits) MEMBER(SampleHits, tests)                                       \
  STRUCT(SurfacePoint)                                                                       \
  MEMBER(SurfacePoint, position) MEMBER(SurfacePoint, t) MEMBER(SurfacePoint, normal)        \
  MEMBER(SurfacePoint, offset) MEMBER(SurfacePoint, area) MEMBER(SurfacePoint, pixel)        \
  MEMBER(SurfacePoint, sample) MEMBER(SurfacePoint, visits)                                  \
  STRUCT(SampleAlbedo) MEMBER(SampleAlbedo, color)                                            \
  STRUCT(LightRecord)                                                                        \
  MEMBER(LightRecord, position) MEMBER(LightRecord, radius) MEMBER(LightRecord, direction)   \
  MEMBER(LightRecord, one_minus_cos) MEMBER(LightRecord, edge_u) MEMBER(LightRecord, area)   \
  MEMBER(LightRecord, edge_v) MEMBER(LightRecord, inner_cone) MEMBER(LightRecord, outer_cone) \
  MEMBER(LightRecord, kind) MEMBER(LightRecord, first_triangle)                              \
  MEMBER(LightRecord, triangle_count) MEMBER(LightRecord, two_sided)                         \
  MEMBER(LightRecord, id) MEMBER(LightRecord, environment_first)                             \
  MEMBER(LightRecord, environment_width) MEMBER(LightRecord, environment_height)             \
  MEMBER(LightRecord, rotation) MEMBER(LightRecord, sequence)                                \
  STRUCT(EmitterTriangle)                                                                    \
  MEMBER(EmitterTriangle, vertex) MEMBER(EmitterTriangle, area)                              \
  MEMBER(EmitterTriangle, edge1) MEMBER(EmitterTriangle, left_share)                         \
  MEMBER(EmitterTriangle, edge2) MEMBER(EmitterTriangle, spare)                              \
  MEMBER(EmitterTriangle, left) MEMBER(EmitterTriangle, right)                               \
  STRUCT(SceneParams)                                                                        \
  MEMBER(SceneParams, root) MEMBER(SceneParams, has_top)                                     \
  STRUCT(OcclusionParams)                                                                    \
  MEMBER(OcclusionParams, scene) MEMBER(OcclusionParams, ray_count)                          \
  MEMBER(OcclusionParams, footprint) MEMBER(OcclusionParams, inverse_distance)               \
  MEMBER(OcclusionParams, falloff) MEMBER(OcclusionParams, roulette)                         \
  MEMBER(OcclusionParams, rays_per_point)                                                    \
  MEMBER(OcclusionParams, large_batches) MEMBER(OcclusionParams, batches_per_ticket)                \
  STRUCT(PixelWork) MEMBER(PixelWork, pixel) MEMBER(PixelWork, first_sample)                 \
  STRUCT(SliceParams)                                                                        \
  MEMBER(SliceParams, first_work) MEMBER(SliceParams, pixel_count)                          \
  MEMBER(SliceParams, first_sample) MEMBER(SliceParams, sample_count)                        \
  STRUCT(CameraParams)                                                                       \
  MEMBER(CameraParams, slice) MEMBER(CameraParams, scene) MEMBER(CameraParams, to_world)     \
  MEMBER(CameraParams, half_width) MEMBER(CameraParams, half_height)                         \
  MEMBER(CameraParams, orthographic) MEMBER(CameraParams, lens_radius)                       \
  MEMBER(CameraParams, inverse_focus) MEMBER(CameraParams, width)                            \
  MEMBER(CameraParams, height) MEMBER(CameraParams, crop_x) MEMBER(CameraParams, crop_y)     \
  MEMBER(CameraParams, crop_width) MEMBER(CameraParams, seed)                                \
  MEMBER(CameraParams, inverse_spp) MEMBER(CameraParams, texel_share)                        \
  MEMBER(CameraParams, tap_offset) MEMBER(CameraParams, tap_centring) MEMBER(CameraParams, medium_error)                             \
  MEMBER(CameraParams, splitting_bits) MEMBER(CameraParams, keep_hits)                       \
  MEMBER(CameraParams, seen_left)                                                            \
  MEMBER(CameraParams, seen_above) MEMBER(CameraParams, seen_right)                          \
  MEMBER(CameraParams, seen_below)                                                           \
  STRUCT(Viewpoint)                                                                          \
  MEMBER(Viewpoint, at) MEMBER(Viewpoint, to_points) MEMBER(Viewpoint, is_known)             \
  STRUCT(AoParams)                                                                           \
  MEMBER(AoParams, point_count) MEMBER(AoParams, rays) MEMBER(AoParams, inverse_count)       \
  MEMBER(AoParams, t_max) MEMBER(AoParams, seed) MEMBER(AoParams, whole_sets)                \
  MEMBER(AoParams, shaded) MEMBER(AoParams, viewpoint)                                       \
  STRUCT(LightParams)                                                                        \
  MEMBER(LightParams, point_count) MEMBER(LightParams, rays)                                 \
  MEMBER(LightParams, inverse_count) MEMBER(LightParams, light) MEMBER(LightParams, seed)    \
  MEMBER(LightParams, shaded) MEMBER(LightParams, viewpoint)                                 \
  STRUCT(ResolveParams)                                                                      \
  MEMBER(ResolveParams, slice) MEMBER(ResolveParams, film_pixels)                            \
  MEMBER(ResolveParams, first_sample)                                                        \
  MEMBER(ResolveParams, plane) MEMBER(ResolveParams, rays) MEMBER(ResolveParams, squares)    \
  MEMBER(ResolveParams, backs) MEMBER(ResolveParams, visits) MEMBER(ResolveParams, albedo)   \
  MEMBER(ResolveParams, splitting_bits)                                                      \
  MEMBER(ResolveParams, scale)                                                               \
  MEMBER(ResolveParams, position_scale) MEMBER(ResolveParams, depth_scale)                   \
  MEMBER(ResolveParams, axis) MEMBER(ResolveParams, eye)                           \
  STRUCT(BackParams)                                                                         \
  MEMBER(BackParams, resolve) MEMBER(BackParams, group_bits) MEMBER(BackParams, seed)        \
  MEMBER(BackParams, width) MEMBER(BackParams, crop_x) MEMBER(BackParams, crop_y)            \
  MEMBER(BackParams, crop_width) MEMBER(BackParams, slots)                                   \
  MEMBER(BackParams, first_packed)                                                           \
  STRUCT(ShadingParams)                                                                      \
  MEMBER(ShadingParams, resolve) MEMBER(ShadingParams, normals)                              \
  MEMBER(ShadingParams, albedo) MEMBER(ShadingParams, resolves)                              \
  MEMBER(ShadingParams, segment_words) MEMBER(ShadingParams, color_share)                    \
  MEMBER(ShadingParams, viewpoint)                                                           \
  STRUCT(ColorMaterial)                                                                      \
  MEMBER(ColorMaterial, color) MEMBER(ColorMaterial, mips) MEMBER(ColorMaterial, width)      \
  MEMBER(ColorMaterial, height) MEMBER(ColorMaterial, flags) MEMBER(ColorMaterial, spare)    \
  MEMBER(ColorMaterial, offset) MEMBER(ColorMaterial, spares)

/* clang-format on */

#endif
