"""Bugs in kernels/: in the variants that a render uses by default unless the name says otherwise."""

from mutation import Mutation

MUTATIONS = [
    Mutation(
        "rays-start-above-the-largest-axis", "kernels/camera/surface_points16.clh",
        "normal_error += fabs(normal[axis]) * terms[axis] +",
        "normal_error += sqrt(dot_16(normal, normal)) * terms[axis] +",
        r"^RayOrigin\."),
    Mutation(
        "sums-forget-earlier-rounds", "kernels/film/film.clh",
        "pixel.has_samples = entry.first_sample + params.slice.first_sample != params.first_sample;",
        "pixel.has_samples = params.slice.first_sample != 0u;",
        r"^Resume\."),
    Mutation(
        "sums-forget-earlier-slices", "kernels/film/film.clh",
        "pixel.has_samples = entry.first_sample + params.slice.first_sample != params.first_sample;",
        "pixel.has_samples = entry.first_sample != params.first_sample;",
        r"^SliceSums\."),
    Mutation(
        "slab-sign", "kernels/occlusion/packet_node.clh",
        "const bool flip = in_order && rays->backward[axis];",
        "const bool flip = in_order && !rays->backward[axis];",
        r"^(Packet|ClosedForm)\."),
    Mutation(
        "normals-face-away-from-the-viewer", "kernels/shading/smooth_point.clh",
        "if (!(towards < 0.0f)) return normal;",
        "return normal;",
        r"^ShadingNormal\."),
    Mutation(
        "mass-poles-decoded-on-the-other-side", "kernels/opacity/footprint.clh",
        "off_pole_along(node, 1, y,",
        "off_pole_along(node, 1, -y,",
        r"^(Packet|ScalarKernels|HardScenes)\."),
    Mutation(
        "slab-sign-of-single-rays", "kernels/geometry/node.clh",
        "const int forward = inverse > 0.0f;",
        "const int forward = inverse < 0.0f;",
        r"^(Traversal|Packet|PacketsOption)\."),
    Mutation(
        "roulette-keeps-what-rays-have", "kernels/occlusion/packet.clh",
        "return hidden ? (float8)(0.0f) : max(value, roulette_floor(params));",
        "return hidden ? (float8)(0.0f) : value;",
        r"^Roulette\."),
    Mutation(
        "roulette-draws-the-same-for-all-rays", "kernels/occlusion/roulette.clh",
        "(float)(hash_uint(key) >> 8)",
        "(float)(hash_uint(7u) >> 8)",
        r"^Roulette\."),
    Mutation(
        "normals-face-the-middle-of-the-lens", "kernels/shading/smooth_point.clh",
        "to_viewer -= 2.0f * fmin(dot(geometric, to_viewer), 0.0f) * geometric;",
        "to_viewer *= dot(geometric, to_viewer) < 0.0f ? -1.0f : 1.0f;",
        r"^ShadingNormal\."),
    Mutation(
        "roulette-keeps-what-single-rays-have", "kernels/occlusion/traverse.clh",
        "result.value < min_transmittance ? 0.0f : max(result.value, roulette_floor(params));",
        "result.value < min_transmittance ? 0.0f : result.value;",
        r"^Roulette\."),
    Mutation(
        "roulette-keeps-what-scalar-rays-have", "kernels/scalar/transmittance.clh",
        "fmax(traversal.found.value, roulette_floor(params))",
        "traversal.found.value",
        r"^Roulette\."),
    Mutation(
        "forgotten-child", "kernels/occlusion/packet_stack.clh",
        "  const uint inner_mask = node->inner_mask;\n#ifdef DAPPLE_PACK_8_INTS",
        "  const uint inner_mask = node->inner_mask & 0x7fu;\n#ifdef DAPPLE_PACK_8_INTS",
        r"^(Packet|Traversal|Oracle|OracleRays)\."),
    Mutation(
        "swapped-axes-of-opacity", "kernels/occlusion/packet_depth_many.clh",
        "  const float8 y = decode_depths(node, 1) * seen.faces[1];\n"
        "  const float8 z = decode_depths(node, 2) * seen.faces[2];\n",
        "  const float8 y = decode_depths(node, 2) * seen.faces[1];\n"
        "  const float8 z = decode_depths(node, 1) * seen.faces[2];\n",
        r"^(Packet|PacketPicture|PrefilterConvergence|Traversal)\."),
    Mutation(
        "swapped-axes-of-opacity-at-points", "kernels/occlusion/packet_depth_one.clh",
        "  const float8 part_y = decode_depths(node, 1) * facing_y;\n"
        "  const float8 part_z = decode_depths(node, 2) * facing_z;\n",
        "  const float8 part_y = decode_depths(node, 2) * facing_y;\n"
        "  const float8 part_z = decode_depths(node, 1) * facing_z;\n",
        r"^(Packet|PointSets|PointAo|PrefilterConvergence|Traversal)\."),
    Mutation(
        "pdf-of-dome-off-by-two", "kernels/lights/dome_samples.clh",
        "0.5f * cosine_pdf + samples->radiance.v * (0.125f / M_PI_F)",
        "cosine_pdf + samples->radiance.v * (0.25f / M_PI_F)",
        r"^(Dome|DomeRange)\."),
    Mutation(
        "pdf-of-sphere-off-by-two", "kernels/lights/light_samples.clh",
        "samples->solid_angle.v = 2.0f * M_PI_F * one_minus_cos;",
        "samples->solid_angle.v = M_PI_F * one_minus_cos;",
        r"^(Light|LightSampling|SpotLight)\."),
    Mutation(
        "rects-without-the-distance-of-the-line", "kernels/lights/rect_sample.clh",
        "* range * (near_square + at * at) / line_square;",
        "* range;",
        r"^RectSampling\."),
    Mutation(
        "sampler-without-pixel", "kernels/sampling/random.clh",
        "const uint key = hash_pair(hash_pair(pixel, pair), seed);",
        "const uint key = hash_pair(hash_uint(pair), seed);",
        r"^(Sampling|Determinism)\."),
    Mutation(
        "footprints-without-sample-index", "kernels/sampling/random.clh",
        "hash_pair(hash_pair(pixel, pair ^ 0x5851f42du), hash_pair(index, seed))",
        "hash_pair(hash_pair(pixel, pair ^ 0x5851f42du), hash_uint(seed))",
        r"^(Sampling|Popping)\."),
    Mutation(
        "falloff-ignored-at-covered-nodes", "kernels/occlusion/packet_depth.clh",
        "    if (falloff) part = depth_with_falloff(params, part, 0.5f * (enter + leave));\n",
        "",
        r"^(AoDistance|Packet)\."),
    Mutation(
        "falloff-ignored-at-textures", "kernels/occlusion/packet.clh",
        "  vstore8(surface_depths(1.0f - with_falloff(params, opacity.lo, t.lo)), 0, depth);\n"
        "  vstore8(surface_depths(1.0f - with_falloff(params, opacity.hi, t.hi)), 1, depth);\n",
        "  vstore8(surface_depths(1.0f - opacity.lo), 0, depth);\n"
        "  vstore8(surface_depths(1.0f - opacity.hi), 1, depth);\n",
        r"^(AoDistance|Packet)\."),
    Mutation(
        "alpha-cutoff-greater", "kernels/opacity/opacity_lookup.clh",
        "alpha >= records->cutoff ?",
        "alpha > records->cutoff ?",
        r"^(OpacityLookup|TexturedTriangle|GltfMaterial)\."),
    Mutation(
        "wrap-mode-mirror", "kernels/opacity/texel_addresses.clh",
        "min(mirrored, 2.0f - mirrored)",
        "min(mirrored, 1.0f)",
        r"^(OpacityLookup|MipFootprint)\."),
    Mutation(
        "wrap-mode-repeat-at-the-edge", "kernels/opacity/texel_addresses.clh",
        "pairs.first = cell < 0 ? last - beyond : min(cell, last);",
        "pairs.first = clamp(cell, (int16)(0), last);",
        r"^(OpacityLookup|MipFootprint)\."),
    Mutation(
        "radiance-of-dome-ignored", "kernels/lights/light.cl",
        "solid_angle * at_least_0(cosine) * samples->radiance.v",
        "solid_angle * at_least_0(cosine)",
        r"^(Dome|DomeRange|Light)\."),
    Mutation(
        "dome-turns-the-other-way", "kernels/lights/dome.clh",
        "const float across = x * dome->cosine - z * dome->sine;\n"
        "  const float along = x * dome->sine + z * dome->cosine;",
        "const float across = x * dome->cosine + z * dome->sine;\n"
        "  const float along = z * dome->cosine - x * dome->sine;",
        r"^Dome\."),
    Mutation(
        "one-sided-mesh-light-shines-back", "kernels/lights/mesh_sample.clh",
        "fmax(two_sided ? fabs(cosine) : cosine, 0.0f)",
        "fabs(cosine)",
        r"^(EmissiveMesh|DiskLight|Light)\."),
    Mutation(
        "spot-cone-without-square", "kernels/lights/light_samples.clh",
        "samples->solid_angle.v *= edge * edge;",
        "samples->solid_angle.v *= edge;",
        r"^SpotLight\."),
    Mutation(
        "mesh-lights-occlude-nothing", "kernels/occlusion/packet.clh",
        "if (instance->light && instance->light == light) continue;",
        "if (instance->light) continue;",
        r"^(EmissiveMesh|Light)\."),
    Mutation(
        "footprint-without-cosine", "kernels/occlusion/ao_rays.clh",
        "min(M_PI_F * params.inverse_count / cosine, 2.0f * M_PI_F)",
        "min(M_PI_F * params.inverse_count, 2.0f * M_PI_F)",
        r"^(Sampling|PointSets|PointAo|PrefilterConvergence)\."),
    Mutation(
        "hides-rays-above-the-surface", "kernels/occlusion/point_rays.clh",
        "(rays->facing.v != 0u) & (cosine <= 0.0f)",
        "(rays->facing.v != 0u) & (cosine >= 0.0f)",
        r"^(ShadingNormal|SmoothBake)\."),
    Mutation(
        "hidden-rays-count-as-free", "kernels/film/film.cl",
        "const float seen = found.transmittance * rays[ray].weight;",
        "const float seen = found.transmittance;",
        r"^ShadingNormal\."),
    Mutation(
        "hidden-rays-count-as-free-at-points", "kernels/occlusion/point_ao.cl",
        "((long)(count - traced) - (long)below) * (long)DAPPLE_AO_STEPS",
        "(long)(count - traced) * (long)DAPPLE_AO_STEPS",
        r"^(ShadingNormal|SmoothBake|PointAo)\."),
    Mutation(
        "shading-normal-as-a-direction", "kernels/shading/smooth_point.clh",
        "normal = placed_normal(at->to_object, normal);",
        "normal = transform_vector(at->to_world, normal);",
        r"^(ShadingNormal|GltfNormals)\."),
    Mutation(
        "shading-normal-of-the-wrong-corner", "kernels/shading/shading_normal.clh",
        "corner_normals(first >> 21 | (last & 1023u) << 11, normal1);\n"
        "  corner_normals(last >> 10 & 0x1fffffu, normal2);",
        "corner_normals(last >> 10 & 0x1fffffu, normal1);\n"
        "  corner_normals(first >> 21 | (last & 1023u) << 11, normal2);",
        r"^ShadingNormal\."),
    Mutation(
        "batches-begin-a-sample-late", "kernels/film/film.clh",
        "if ((sample + 1u) % DAPPLE_SAMPLE_BATCH) return;",
        "if (sample % DAPPLE_SAMPLE_BATCH) return;",
        r"^(AdaptiveSampling|FilmMoments|Targets)\."),
    Mutation(
        "lens-bends-outwards", "kernels/camera/camera.clh",
        "rays->direction[axis] -= offset * params.inverse_focus;",
        "rays->direction[axis] += offset * params.inverse_focus;",
        r"^DepthOfField\."),
    Mutation(
        "pixel-footprint-with-a-square", "kernels/camera/camera.clh",
        "pixel_area * shrink * shrink * shrink",
        "pixel_area * shrink * shrink",
        r"^CameraPoints\."),
    Mutation(
        "last-surface-instead-of-first", "kernels/camera/k_buffer.clh",
        "hit & (cumulative > threshold) & (at->cumulative.v <= threshold)",
        "hit & (at->cumulative.v <= threshold)",
        r"^(KBufferOnDevice|CameraSplitting|DeepAlpha)"),
    Mutation(
        "vertex-colour-without-decoding", "kernels/shading/color_entry.clh",
        "  return root * root;\n",
        "  return root;\n",
        r"^(Albedo|GltfColors)\."),
    Mutation(
        "bilinear-weight-of-colours", "kernels/shading/surface_color.clh",
        "weight[0] = 1.0f - at.right - weight[2];",
        "weight[0] = 1.0f - at.right - at.down;",
        r"^Albedo\."),
    Mutation(
        "caps-only-where-the-cone-is-hit", "kernels/intersect/segments.clh",
        "const int16 capped = of_caps & ~hits.hit;",
        "const int16 capped = of_caps & of_cone & ~hits.hit;",
        r"^Strands\."),
    Mutation(
        "strands-without-thin-ends", "kernels/intersect/segments.clh",
        "((square > 0.0f) | (widening > 0.0f))",
        "(square > 0.0f)",
        r"^Strands\."),
    Mutation(
        "normals-behind-their-face", "kernels/shading/smooth_point.clh",
        "normal -= 2.0f * fmin(dot(normal, geometric), 0.0f) * geometric;",
        "normal -= 0.0f * geometric;",
        r"^(ShadingNormal|SmoothNormals|ShadingPass)"),
    Mutation(
        "emitters-without-the-probability-of-right-parts", "kernels/lights/mesh_sample.clh",
        "const float16 chosen = to_left ? probability : 1.0f - probability;",
        "const float16 chosen = to_left ? probability : 1.0f;",
        r"^(LightSampling|EmissiveMesh)\."),
    Mutation(
        "wrong-caps-of-strands", "kernels/intersect/segments.clh",
        "segments.end_cap = lanes_of_bits(block->end_caps);",
        "segments.end_cap = lanes_of_bits(block->begin_caps);",
        r"^(Strands|SegmentBlock)\."),
    Mutation(
        "scalar-swapped-axes-of-opacity", "kernels/scalar/child_depth.clh",
        "decode_depth(node->depth[0][slot]), decode_depth(node->depth[1][slot]),",
        "decode_depth(node->depth[1][slot]), decode_depth(node->depth[0][slot]),",
        r"^ScalarKernels\."),
    Mutation(
        "rays-to-lights-reach-them", "kernels/lights/light.cl",
        "return at_least_0(distance * (1.0f - DAPPLE_LIGHT_GAP) - largest * DAPPLE_LIGHT_ROUNDINGS);",
        "return distance + 0.0f * largest;",
        r"^Light\."),
    Mutation(
        "disks-are-near-by-their-centre", "kernels/lights/flat_samples.clh",
        "return height * height + beyond * beyond;",
        "return square + 0.0f * beyond;",
        r"^DiskLight\."),
    Mutation(
        "sums-of-other-points-rays", "kernels/occlusion/ray_sums.cl",
        "const uint end = min(first + DAPPLE_SUMMED_RAYS, (point + 1u) * rays_per_point);",
        "const uint end = first + DAPPLE_SUMMED_RAYS;",
        r"^RaySums\."),
    Mutation(
        "scalar-falloff-ignored", "kernels/scalar/primitive_transmittance.clh",
        "  return opacity * powr(fmax(1.0f - t * params.inverse_distance, 0.0f), params.falloff);\n",
        "  return opacity;\n",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-leaves-evaluated-in-another-space", "kernels/scalar/transmittance.clh",
        "      if (is_postponed(&traversal->postponed)) return false;\n",
        "",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-caps-of-strands-inside-out", "kernels/scalar/segment.clh",
        "cap_distance(-position, direction, of.begin_plane, of.radius, -1.0f);",
        "cap_distance(-position, direction, of.begin_plane, of.radius, 1.0f);",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-texels-of-the-wrong-row", "kernels/scalar/textured_opacity.clh",
        "__global const uchar* lower = level->texels + rows.y * (int)level->width;",
        "__global const uchar* lower = level->texels + rows.x * (int)level->width;",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-rays-forget-what-they-passed", "kernels/scalar/closest_hits.clh",
        "  hits->passed = cumulative;\n",
        "",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-media-stop-rays-where-they-begin", "kernels/scalar/medium.clh",
        "const float t = mix(chosen.hit.enter, chosen.hit.leave, along);",
        "const float t = chosen.hit.enter;",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-spot-cone-without-square", "kernels/lights/light_sample.clh",
        "sample.solid_angle *= edge * edge;",
        "sample.solid_angle *= edge;",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-pdf-of-dome-off-by-two", "kernels/lights/light_sample.clh",
        "0.5f * cosine_pdf + *radiance * (0.125f / M_PI_F);",
        "cosine_pdf + *radiance * (0.25f / M_PI_F);",
        r"^ScalarKernels\."),
    Mutation(
        "scalar-hides-rays-above-the-surface", "kernels/scalar/point_ray.clh",
        "(float3)(facing[0], facing[1], facing[2])) > 0.0f) return;",
        "(float3)(facing[0], facing[1], facing[2])) < 0.0f) return;",
        r"^ScalarKernels\."),
    Mutation(
        "groups-count-their-own-hits-as-earlier", "kernels/film/compact.cl",
        "i < get_group_id(0); i += DAPPLE_SCAN_ITEMS)",
        "i <= get_group_id(0); i += DAPPLE_SCAN_ITEMS)",
        r"^ScalarKernels\."),
    Mutation(
        "light-times-the-albedo-of-the-first-sample", "kernels/film/film.clh",
        "? load3(albedos[sample].color)",
        "? load3(albedos[0].color)",
        r"^Beauty\."),
    Mutation(
        "areas-without-a-unit", "kernels/occlusion/packet_node.clh",
        "return bvh_scale((uchar)clamp(127 - 2 * (largest - 127), 1, 254));",
        "return 1.0f + 0.0f * (float)largest;",
        r"^Units\."),
    Mutation(
        "cosine-that-cancels-beside-an-edge", "kernels/lights/mesh_sample.clh",
        "const float one_plus_cosine = 0.5f * dot(sum, sum);",
        "const float one_plus_cosine = 1.0f + dot(a, b) + 0.0f * sum.x;",
        r"^Light\."),
]
