"""Bugs in what happens before a ray is traced: host/scene, host/bvh, host/device, host/camera, motion."""

from mutation import Mutation

MUTATIONS = [
    Mutation(
        "matrices-without-padding", "host/scene/gltf/document/accessor.cpp",
        "layout.column_stride = is_matrix ? (column + 3) / 4 * 4 : column;",
        "layout.column_stride = column;",
        r"^BakeCommand\.Matrices"),
    Mutation(
        "instances-of-mirrored-skins-are-mirrored", "host/scene/gltf/instance.cpp",
        "matrices.push_back(is_skinned ? placed.to_world * of_instance",
        "matrices.push_back(!is_skinned ? placed.to_world * of_instance",
        r"^(GltfSkin|GltfHierarchy|GltfGeometry)\."),
    Mutation(
        "emission-of-what-is-cut-out", "host/device/upload/light_upload.cpp",
        "const double area = 0.5 * edge1.cross(edge2).length() * double{opacities[t]};",
        "const double area = 0.5 * edge1.cross(edge2).length() * (opacities[t] > 0 ? 1 : 0);",
        r"^EmissiveMesh\."),
    Mutation(
        "placements-move-by-the-first-one", "host/render/frame_match.cpp",
        "if (instances[i] < 0) continue;\n    const std::uint32_t mesh",
        "if (instances[i] < 0) break;\n    const std::uint32_t mesh",
        r"^Motion\."),
    Mutation(
        "bakes-keep-their-rays-to-lights", "host/bake/vertex_bake.cpp",
        "std::clamp<std::int64_t>(light_rays, options.light_rays, kMostLightRays)",
        "std::min<std::int64_t>(light_rays, options.light_rays)",
        r"^(BakeLight|SampleCounts)\."),
    Mutation(
        "quantization-rounds-inwards", "host/bvh/build/quantize_boxes.cpp",
        "std::floor((box.min[axis] - origin) / step - margin(box.min[axis], step));",
        "std::ceil((box.min[axis] - origin) / step - margin(box.min[axis], step));",
        r"^(Quantize|Bvh|Watertight)\."),
    Mutation(
        "refit-skips-the-root", "host/bvh/refit/refit_object.cpp",
        "                          if (upper.nodes[n].child_count > 0)\n"
        "                            set_boxes(",
        "                          if (upper.nodes[n].child_count > 0 && n > 0)\n"
        "                            set_boxes(",
        r"^(Refit|SwayingTree|Renderer)\."),
    Mutation(
        "refit-skips-areas-of-subtrees", "host/bvh/refit/refit_subtree.cpp",
        "  to.areas.add(part.areas);\n",
        "",
        r"^(Refit|SwayingTree|Renderer)\."),
    Mutation(
        "refitted-blocks-are-not-uploaded", "host/bvh/refit/updatable_bvh.cpp",
        "    update.blocks.push_back({offsets[m].block, offsets[m + 1].block});\n",
        "",
        r"^(Renderer|Refit|SwayingTree)\."),
    Mutation(
        "texels-of-refitted-triangles-keep-their-size", "host/bvh/refit/updatable_bvh.cpp",
        "    if (is_kept[m] && resize_texels(scene, m)) update.textured = true;\n",
        "",
        r"^(Renderer|Refit)\."),
    Mutation(
        "colours-of-refitted-triangles-keep-their-texels", "host/device/upload/scene_upload.cpp",
        "  if (options.colors && changes.objects_refitted > 0 && !moved.color_textures.empty()) {\n",
        "  if (false) {\n",
        r"^Renderer\."),
    Mutation(
        "edges-of-many-leaves-join-them", "host/bvh/opacity/closed_surface.cpp",
        "if (entry.triangles == 2)", "if (entry.triangles >= 2)",
        r"^ClosedSurface\."),
    Mutation(
        "split-vertices-open-surfaces", "host/bvh/opacity/closed_surface.cpp",
        "if (entry.triangles == 2)", "if (entry.triangles == 1)",
        r"^ClosedSurface\."),
    Mutation(
        "quads-with-a-dent-drawn-as-one", "host/bvh/opacity/coverage_map.cpp",
        "at_b < 0.0f || at_c < 0.0f : at_b > 0.0f || at_c > 0.0f",
        "at_b < 0.0f && at_c < 0.0f : at_b > 0.0f && at_c > 0.0f",
        r"^(CoverageMap|SharedEdges)\."),
    Mutation(
        "triangles-of-a-leaf-overlap-though-they-share-an-edge",
        "host/bvh/opacity/covering_triangle.cpp",
        "neighbours[a] = static_cast<std::uint16_t>(neighbours[a] | 1u << b);", "",
        r"^(CoverageMap|SharedEdges)\."),
    Mutation(
        "images-decoded-ahead-are-of-others", "host/scene/gltf/decoded_images.cpp",
        "ahead_.emplace(batch[i].first,", "ahead_.emplace(batch[batch.size() - 1 - i].first,",
        r"^GltfColors\."),
    Mutation(
        "alphas-beyond-the-border-do-not-count", "host/bvh/opacity/opacity_mip_levels.cpp",
        "wrapped_texel(-1, width, texture.wrap_s)", "0",
        r"^(OpacityMipLevels|CutOutLevels|CoverageMap|OpacityLookup)\."),
    Mutation(
        "rings-forget-the-last-corner", "host/bvh/opacity/wall.cpp",
        "ring ^= hash_of(next) ^ hash_of(last);", "ring ^= hash_of(next);",
        r"^(InteriorTriangles|Wall)\."),
    Mutation(
        "nothing-is-a-wall", "host/bvh/opacity/wall.cpp",
        "  if (!(areas.interior > kInteriorShare * areas.all)) return false;\n",
        "  if (!(areas.interior < 0.0f)) return false;\n",
        r"^(Wall|HardScenes)\."),
    Mutation(
        "no-node-is-small-inside-a-cave", "host/bvh/opacity/wall.cpp",
        "extent * areas.interior < kSmallInside * areas.chords",
        "extent * areas.interior < 0.01f * areas.chords",
        r"^(Scenes/ClosedSurfaces|Wall)\."),
    Mutation(
        "volumes-of-surfaces-that-face-both-sides-cancel", "host/bvh/opacity/wall.cpp",
        "return faces_both_sides() ? cones / 3 :",
        "return false ? cones / 3 :",
        r"^InteriorTriangles\."),
    Mutation(
        "mass-poles-on-the-other-side-along-y", "host/bvh/opacity/node_opacity.cpp",
        "V3f(pole[0], pole[1], pole[2])",
        "V3f(pole[0], -pole[1], pole[2])",
        r"^MassShape\."),
    Mutation(
        "mass-poles-of-instances-on-the-other-side", "host/bvh/build/top_level.cpp",
        "std::clamp(1.5f * place / mass.concentration,",
        "std::clamp(-1.5f * place / mass.concentration,",
        r"^InstanceMass\."),
    Mutation(
        "opaque-triangles-with-vertices-of-the-mesh", "host/bvh/opacity/opaque_triangles.cpp",
        "    const std::uint32_t lower = words_[vertex / 32] & ((1u << vertex % 32) - 1);\n",
        "    const std::uint32_t lower = words_[vertex / 32];\n",
        r"^OpaqueTriangles\."),
    Mutation(
        "cache-key-without-opacity", "host/bvh/storage/object_key.cpp",
        "  key.add_value(material.alpha);\n",
        "",
        r"^(BvhCache|CacheCommand)\."),
    Mutation(
        "cache-key-without-wrap-mode", "host/bvh/storage/object_key.cpp",
        "  key.add_value(texture.wrap_t);\n",
        "",
        r"^(BvhCache|CacheCommand)\."),
    Mutation(
        "swapped-correlations", "host/bvh/opacity/node_opacity.cpp",
        "return {of(3, 0, 1), of(4, 1, 2), of(5, 2, 0)};",
        "return {of(3, 0, 1), of(5, 2, 0), of(4, 1, 2)};",
        r"^(NormalMoments|OpacityModel|OpacityCode|Clumping)\."),
    Mutation(
        "alpha-cutoff-greater-in-mip-levels", "host/bvh/opacity/opacity_mip_levels.cpp",
        "return alpha >= cutoff ? 1.0f : 0.0f;",
        "return alpha > cutoff ? 1.0f : 0.0f;",
        r"^(OpacityMipLevels|MipFootprint|TexturedTriangle)\."),
    Mutation(
        "mip-factor-of-one-corner", "host/bvh/opacity/texture_integrals.cpp",
        "if (cutoff < 0.0f || is_varied(corners)) return",
        "if (cutoff < 0.0f) return",
        r"^(TexturedTriangle|OpacityMipLevels|MipFootprint|OpacityModel)\."),
    Mutation(
        "opaque-texels-without-the-last", "host/bvh/opacity/opaque_texels.cpp",
        "last = texel(high) + 1;",
        "last = texel(high);",
        r"^(OpaqueTexels|OpacityOfTexels)\."),
    Mutation(
        "opaque-texels-not-mirrored", "host/bvh/opacity/opaque_texels.cpp",
        "const int a = first_period % 2 != 0 ? size - 1 - from : from;",
        "const int a = from;",
        r"^(OpaqueTexels|OpacityOfTexels)\."),
    Mutation(
        "opaque-texels-of-any-vertex-alpha", "host/bvh/opacity/triangle_opacity.cpp",
        "if (material.alpha_mode == AlphaMode::mask && !is_factor_1) return std::nullopt;",
        "(void)is_factor_1;",
        r"^(OpaqueTexels|OpacityOfTexels)\."),
    Mutation(
        "segment-opacity-of-one-end", "host/bvh/opacity/triangle_opacity.cpp",
        "alpha *= 0.5f * (mesh.vertex_alpha[at[0]] + mesh.vertex_alpha[at[1]]);",
        "alpha *= mesh.vertex_alpha[at[0]];",
        r"^(Strands|HairFile|StrandScene)\."),
    Mutation(
        "instance-opacity-without-its-scale", "host/bvh/build/top_level.cpp",
        "opacity_along(object.opacity, size, direction) * facing * matrix_scale(to_world);",
        "double{opacity_along(object.opacity, size, direction)} * facing;",
        r"^(Instance|OpacityModel|PrefilterConvergence)\."),
    Mutation(
        "instance-footprint-upside-down", "host/bvh/build/top_level.cpp",
        "static_cast<float>(1.0 / matrix_scale(instance.to_world));",
        "static_cast<float>(matrix_scale(instance.to_world));",
        r"^MipFootprint\."),
    Mutation(
        "strand-joints-turn-back", "host/bvh/storage/strand_segment.cpp",
        "(same_way ? 1.0f : -1.0f)",
        "(same_way ? -1.0f : 1.0f)",
        r"^(Strands|StrandScene|SegmentBlock)\."),
    Mutation(
        "merged-normals-as-directions", "host/scene/merge.cpp",
        "const M44f of_normals = to_world.inverse().transposed();",
        "const M44f of_normals = to_world;",
        r"^(Merge|GltfNormals|ShadingNormal)\."),
    Mutation(
        "hair-transparency-is-opacity", "host/scene/hair_file.cpp",
        "return 1 - std::clamp(transparency, 0.0f, 1.0f);",
        "return std::clamp(transparency, 0.0f, 1.0f);",
        r"^HairFile\."),
    Mutation(
        "hair-thickness-is-radius", "host/scene/hair_file.cpp",
        "return std::max(thickness / 2, static_cast<float>(kSmallestLength));",
        "return std::max(thickness, static_cast<float>(kSmallestLength));",
        r"^HairFile\."),
    Mutation(
        "gltf-accessor-without-its-offset", "host/scene/gltf/document/accessor.cpp",
        "base_ = view_bytes(document, accessor.bufferView).data() + accessor.byteOffset;",
        "base_ = view_bytes(document, accessor.bufferView).data();",
        r"^(GltfGeometry|LoadScene)\."),
    Mutation(
        "gltf-sparse-values-with-a-stride", "host/scene/gltf/document/accessor.cpp",
        "return sparse_values_ + at * layout_.stride;",
        "return sparse_values_ + at * stride_;",
        r"^(GltfGeometry|GltfMorph)\."),
    Mutation(
        "gltf-rotations-take-the-long-way", "host/scene/gltf/pose/animation.cpp",
        "    to = -to;\n    cosine = -cosine;\n",
        "    cosine = -cosine;\n",
        r"^GltfAnimation\."),
    Mutation(
        "gltf-cubic-tangents-without-interval", "host/scene/gltf/pose/animation.cpp",
        "* from + position.interval * (t3 - 2 * t2 + t) * out_tangent +",
        "* from + (t3 - 2 * t2 + t) * out_tangent +",
        r"^GltfAnimation\."),
    Mutation(
        "gltf-scale-after-rotation", "host/scene/gltf/pose/hierarchy.cpp",
        "matrix[row][column] *= scale[row];",
        "matrix[row][column] *= scale[column];",
        r"^(GltfHierarchy|GltfAnimation)\."),
    Mutation(
        "gltf-bind-matrix-on-the-wrong-side", "host/scene/gltf/pose/deformation.cpp",
        "matrices[j] = bind * matrices[j];",
        "matrices[j] = matrices[j] * bind;",
        r"^GltfSkin\."),
    Mutation(
        "gltf-wrap-mode-of-the-other-axis", "host/scene/gltf/texture.cpp",
        "result.wrap_t = wrap_mode(sampler.wrapT);",
        "result.wrap_t = wrap_mode(sampler.wrapS);",
        r"^GltfMaterial\."),
    Mutation(
        "gltf-texture-turns-the-other-way", "host/scene/gltf/material.cpp",
        "lookup.du = V2f(cosine, -sine) * scale.x;\n  lookup.dv = V2f(sine, cosine) * scale.y;",
        "lookup.du = V2f(cosine, sine) * scale.x;\n  lookup.dv = V2f(-sine, cosine) * scale.y;",
        r"^GltfMaterial\."),
    Mutation(
        "gltf-sun-as-bright-as-a-sine", "host/scene/gltf/light.cpp",
        "irradiance / (std::numbers::pi_v<float> * sine * sine);",
        "irradiance / (std::numbers::pi_v<float> * sine);",
        r"^(GltfLight|Light)\."),
    Mutation(
        "dome-rows-without-solid-angle", "host/device/upload/dome_upload.cpp",
        "rows.push_back(row * texel_solid_angle(environment, y));",
        "rows.push_back(row);",
        r"^(Dome|DomeRange)\."),
    Mutation(
        "joined-panels-are-refitted", "host/bvh/refit/vertex_places.hpp",
        "kOtherPlaces = 0.02;",
        "kOtherPlaces = 2;",
        r"^Refit"),
    Mutation(
        "instance-means-over-object-space", "host/bake/instance_bake.cpp",
        "double{slice.weight[sample]}, value",
        "1.0, value",
        r"^InstanceBake\."),
    Mutation(
        "borders-of-clamped-textures-in-means", "host/bvh/opacity/texture_integrals.cpp",
        "if (levels_->is_beyond_border(corners_.uv)) return;",
        "if (levels_->is_beyond_border({})) return;",
        r"^OpacityMipLevels\."),
    Mutation(
        "rays-average-borders-of-clamped-textures", "host/bvh/opacity/triangle_opacity.cpp",
        "if (averaged && !is_beyond_border(corners.uv, texture.wrap_s, texture.wrap_t))",
        "if (averaged)",
        r"^OpacityMipLevels\."),
    Mutation(
        "cut-outs-not-interpolated", "host/bvh/opacity/opacity_mip_levels.cpp",
        "cutoff >= 0 && !texture.nearest;",
        "cutoff >= 0 && false;",
        r"^OpacityMipLevels\."),
    Mutation(
        "mirrored-emitters-face-inwards", "host/device/upload/light_upload.cpp",
        "const bool mirrored = Imath::M44d(instance.to_world).determinant() < 0;",
        "const bool mirrored = false;",
        r"^(EmissiveMesh|Light)\."),
    Mutation(
        "sun-of-twice-the-angle", "host/device/upload/light_upload.cpp",
        "std::sin(0.5 * light.angular_radius)",
        "std::sin(1.0 * light.angular_radius)",
        r"^(Light|LightSampling|ClosedForm)\."),
    Mutation(
        "crop-off-by-one", "host/camera/view.cpp",
        "params.crop_y = static_cast<uint>(view.crop.y0);",
        "params.crop_y = static_cast<uint>(view.crop.y0 + 1);",
        r"^(Crop|View|CameraPoints)\."),
    Mutation(
        "splitting-shrinks-footprints", "host/camera/camera_splitting.cpp",
        "  out.footprint_spp = footprint_samples(options);\n",
        "",
        r"^CameraSplitting\."),
    Mutation(
        "motion-vectors-upside-down", "host/render/motion_lookup.cpp",
        "return {after->x - before->x, before->y - after->y};",
        "return {after->x - before->x, after->y - before->y};",
        r"^Motion\."),
    Mutation(
        "still-instances-do-not-deform", "host/render/motion_lookup.cpp",
        "part.is_there && movement.is_there && (!movement.still || part.deforms);",
        "part.is_there && movement.is_there && !movement.still;",
        r"^Motion\."),
    Mutation(
        "cameras-stand-where-points-do", "host/render/motion_lookup.cpp",
        "if (!moves && camera_stands_) return {0, 0};",
        "if (!moves) return {0, 0};",
        r"^Motion\."),
    Mutation(
        "shutter-without-its-last-moment", "host/render/shutter.cpp",
        "std::int64_t{options.spp} * (time + 1) / times",
        "std::int64_t{options.spp} * time / times",
        r"^Shutter\."),
    Mutation(
        "meshopt-exponents-as-they-are", "host/scene/gltf/document/compressed_views.cpp",
        "if (filter == \"EXPONENTIAL\")",
        "if (filter == \"EXPONENTIALS\")",
        r"^CompressedViews\."),
    Mutation(
        "webp-only-without-a-source", "host/scene/gltf/texture.cpp",
        "if (webp >= 0 && (given.source < 0 || is_there(document, webp))) return webp;",
        "if (webp >= 0 && given.source < 0) return webp;",
        r"^Webp\."),
    Mutation(
        "three-lines-that-meet-are-joined", "host/scene/gltf/line_joints.cpp",
        "if (end - first == 2 &&",
        "if (end - first >= 2 &&",
        r"^GltfLines\."),
    Mutation(
        "areas-of-boxes-without-a-unit", "host/bvh/opacity/node_opacity.cpp",
        "return std::isnormal(most) ?",
        "return most < 0 ?",
        r"^Units\."),
    Mutation(
        "motion-by-whole-runs", "host/render/frame_match.cpp",
        "if (count_of(runs) != count_of(next_runs)) {",
        "if (count_of(runs) != count_of(next_runs) || runs.size() != next_runs.size()) {",
        r"^Motion\."),
    Mutation(
        "dwaa-up-to-the-largest-half", "host/film/exr/exr_writer.cpp",
        "lossy ? kLargestOfDwaa : kLargestHalf",
        "lossy ? kLargestHalf : kLargestHalf",
        r"^ExrFormat"),
    Mutation(
        "each-pose-counts-once", "host/commands/bake/file_values.cpp",
        "Sum(values_of(*use.baked)[use.source->first + i]) * use.weight;",
        "Sum(values_of(*use.baked)[use.source->first + i]) * (weights / static_cast<double>(uses.size()));",
        r"^BakePlacements\."),
    Mutation(
        "parts-of-a-mesh-stay-apart", "host/bake/mesh_borders.cpp",
        "if (set.size() > 1) sets.push_back(std::move(set));",
        "if (set.size() > 1000) sets.push_back(std::move(set));",
        r"^BakePlacements\."),
]
