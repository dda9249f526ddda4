"""Bugs in what happens to traced rays: host/render, host/sampling, host/film, host/bake, host/points, host/compare."""

from mutation import Mutation

MUTATIONS = [
    Mutation(
        "checkpoint-without-the-back-layers", "host/render/partial/picture_record.cpp",
        "  o.back = about.at(\"back\").get<bool>();\n",
        "",
        r"^(CheckpointFile|MergeParts|Resume|MergeCommand)\."),
    Mutation(
        "checkpoint-without-squares", "host/render/picture.cpp",
        "    if (!state_.squares.empty())\n"
        "      context_.write(film_.squares, state_.squares.data(), layout_.square_bytes());\n",
        "",
        r"^(Resume|AdaptiveSampling)\."),
    Mutation(
        "resumes-with-another-falloff", "host/render/render_settings.cpp",
        "      {\"--ao-falloff\", number(options.ao_falloff)},\n",
        "",
        r"^(OptionSettings|Resume)\."),
    Mutation(
        "checksum-of-lights-without-dark-ones", "host/render/render_settings.cpp",
        "  for (const bool dark : scene.dark_lights) stream.add_value(dark);\n",
        "",
        r"^ResumeContent\."),
    Mutation(
        "radiance-of-lights-ignored", "host/film/light_planes.cpp",
        "return V3d(lights_[range.light].radiance) * sum *",
        "return sum *",
        r"^(Light|LightLayers|Beauty)\."),
    Mutation(
        "far-lights-in-coarse-steps", "host/film/sums/film_sums.cpp",
        "constexpr int kSmallestBits = 28,",
        "constexpr int kSmallestBits = 0,",
        r"^SmallLights\."),
    Mutation(
        "backs-of-missing-shards-are-misses", "host/film/back_sources.cpp",
        "      if (!needs(pixel)) continue;\n",
        "      if (needs(pixel)) continue;\n",
        r"^(MergeParts|BackSources)\."),
    Mutation(
        "misses-count-as-occluded", "host/film/layers.cpp",
        "sums_.at(plane, p) / (double{layout_.unit_scale} * options_.ao_rays * samples) + 1.0 -\n"
        "           hit / samples;",
        "sums_.at(plane, p) / (double{layout_.unit_scale} * options_.ao_rays * samples) + 0 * hit;",
        r"^(Beauty|Film|PictureChannels|ClosedForm)\."),
    Mutation(
        "means-over-samples-instead-of-hits", "host/film/layers.cpp",
        "three(plane, p) / (scale * hits(p));",
        "three(plane, p) / (scale * spp(p));",
        r"^(PictureChannels|Albedo|ShadingNormal)\."),
    Mutation(
        "bent-normal-begins-a-plane-early", "host/film/layers.cpp",
        "const V3d bent = three(layout_.ao + DAPPLE_PLANE_AO_BENT, p);",
        "const V3d bent = three(layout_.ao, p);",
        r"^PictureChannels\."),
    Mutation(
        "cryptomatte-ranks-ascend", "host/film/cryptomatte.cpp",
        "? a.count > b.count :",
        "? a.count < b.count :",
        r"^(Cryptomatte|CryptomatteRender)\."),
    Mutation(
        "hash-of-a-reversed-tail", "host/film/cryptomatte.cpp",
        "rest |= byte(k) << (8 * (k - i));",
        "rest = rest << 8 | byte(k);",
        r"^(Murmur3|MatteId)\."),
    Mutation(
        "merged-mattes-keep-the-last", "host/film/sums/matte_sums.cpp",
        "slot->first = std::min(slot->first, one.first);",
        "slot->first = std::max(slot->first, one.first);",
        r"^(MatteSums|CryptomatteResume|MergeParts)\."),
    Mutation(
        "deep-alphas-of-all-samples", "host/film/sums/deep_sums.cpp",
        "      left -= slot.count;\n",
        "",
        r"^(DeepSums|DeepAlpha)\."),
    Mutation(
        "deep-samples-merge-to-the-wrong-side", "host/film/sums/deep_sums.cpp",
        "* (b / (a + b))",
        "* (a / (a + b))",
        r"^DeepSums\."),
    Mutation(
        "lossy-normals", "host/film/exr/exr_parts.cpp",
        "lossy && !part->color ? ExrCompression::zip",
        "lossy && part->color ? ExrCompression::zip",
        r"^ExrFormatTest\."),
    Mutation(
        "png-without-dividing-by-alpha", "host/film/preview/png.cpp",
        "tone_mapped(linear * (scale / alpha))",
        "tone_mapped(linear * scale)",
        r"^Png\."),
    Mutation(
        "merged-samples-of-the-last-part", "host/render/partial/merged_sums.cpp",
        "state_.samples[at(p)] += state.samples[p];",
        "state_.samples[at(p)] = state.samples[p];",
        r"^(MergeParts|MergeCommand)\."),
    Mutation(
        "parts-merge-in-spite-of-footprints", "host/render/partial/merge.cpp",
        "  settings.emplace_back(\"--spp (footprints)\", fmt::format(\"{}\", about.footprint_spp));\n",
        "",
        r"^(MergeParts|MergeCommand)\."),
    Mutation(
        "parts-that-touch-overlap", "host/render/partial/pieces.cpp",
        "a.rays.first < b.rays.end && b.rays.first < a.rays.end;",
        "a.rays.first <= b.rays.end && b.rays.first <= a.rays.end;",
        r"^(Pieces|MergeParts)\."),
    Mutation(
        "target-of-one-pixel", "host/sampling/sample_allocation.cpp",
        "return double{rmse} * rmse * static_cast<double>(pixels);",
        "return double{rmse} * static_cast<double>(pixels);",
        r"^(AdaptiveSampling|SamplePlan|WantEqual|Targets)\."),
    Mutation(
        "freedom-of-pairs-is-that-of-batches", "host/sampling/batch_variance.hpp",
        "std::max(0.0f, over) / (by_pairs ? freedom_of(batches) : count - 1);",
        "std::max(0.0f, over) / (count - 1);",
        r"^(BatchVariances|FilmMoments)\."),
    Mutation(
        "largest-irradiance-with-occlusion", "host/sampling/film_moments.cpp",
        "luminance_sum(pass.planes.unoccluded(), pass.planes.channels, pixel)",
        "luminance_sum(pass.planes.first, pass.planes.channels, pixel)",
        r"^FilmMoments\."),
    Mutation(
        "resumed-rounds-forget-where-they-are", "host/sampling/round.cpp",
        "group.samples - (entry < part_end ? round.sample : 0));",
        "group.samples - (entry <= part_end ? round.sample : 0));",
        r"^(Round|Resume)\."),
    Mutation(
        "tile-bias-with-its-noise", "host/sampling/bias_estimate.cpp",
        "(tile.difference * tile.difference - tile.squared_differences) / pairs;",
        "tile.difference * tile.difference / pairs;",
        r"^(BiasEstimate|BiasReport)\."),
    Mutation(
        "what-may-be-above-the-limit-is-clear", "host/sampling/footprint_choice.cpp",
        "std::fabs(bias.mean) - kClear * bias.error > most;",
        "std::fabs(bias.mean) + kClear * bias.error > most;",
        r"^FootprintChoice\."),
    Mutation(
        "pilot-keeps-what-another-footprint-found", "host/render/bias/bias_pilot.cpp",
        "  if (layer.footprint != footprint) layer.prefiltered.clear();\n",
        "",
        r"^(FootprintPilot|BiasPilot|MaxBias)\."),
    Mutation(
        "pilot-of-the-crop", "host/render/bias/footprint_pilot.cpp",
        "  if (unasked) view.crop = {0, 0, view.width - 1, view.height - 1};\n",
        "",
        r"^FootprintPilot\."),
    Mutation(
        "bias-of-a-group-from-other-passes", "host/render/bias/bias_report.cpp",
        "differences[group.lights[i] + (layout.ao ? 1 : 0)][pixel]",
        "differences[group.lights[i]][pixel]",
        r"^BiasReport\."),
    Mutation(
        "bias-of-resumed-samples", "host/render/bias/bias_report.cpp",
        "    taken.fronts[pixel] -= earlier;\n",
        "",
        r"^(BiasReport|Resume)\."),
    Mutation(
        "backs-of-the-first-sample-of-each-group", "kernels/film/backs.cl",
        "((group + shift) & ((1u << params.group_bits) - 1u)) - of.first_sample;",
        "0u * shift - of.first_sample;",
        r"^Back\."),
    Mutation(
        "backs-of-a-slice-over-those-that-wait", "host/render/back_slices.cpp",
        "choice_.first_packed = static_cast<uint>(samples_of(packed_slice(choice_)));",
        "choice_.first_packed = 0;",
        r"^(Back|BackSlicesOfDevice)\."),
    Mutation(
        "backs-of-cut-groups-forgotten", "host/passes/back_pass.cpp",
        "std::all_of(entries.begin(), entries.end(), begins_group) ? 0 : last;",
        "std::all_of(entries.begin(), entries.end(), begins_group) ? 0 : 0 * last;",
        r"^(BackSlices|BackSlicesOfDevice)\."),
    Mutation(
        "backs-divided-by-all-samples", "host/film/sums/sum_values.hpp",
        "  return std::max(1.0, sums.at(layout.back_samples, pixel));",
        "  return std::max(1.0, 8 * sums.at(layout.back_samples, pixel));",
        r"^Back\."),
    Mutation(
        "bias-correction-of-the-wrong-sign", "host/points/bias_correction.cpp",
        "change_ = difference / fall;", "change_ = -difference / fall;",
        r"^(BiasCorrection|PointBias|SetSums)\."),
    Mutation(
        "correction-by-the-fall-of-the-mean", "host/points/set_sums.hpp",
        "const double fall = of.fall / sets_, corrected",
        "const double fall = fall_with_depth(mean(i)), corrected",
        r"^(SetSums|LocalFootprint)\."),
    Mutation(
        "bias-with-samples-inside", "host/bake/bake_bias.cpp",
        "if (exact.is_inside(i)) continue;", "",
        r"^(InsideSamples|BakeBias)\."),
    Mutation(
        "inside-by-one-ray", "host/bake/inside/closed_geometry.cpp",
        "std::all_of(rays->begin(), rays->end(), winds);", "true;",
        r"^(ClosedGeometry|InsideSamples)\."),
    Mutation(
        "meshes-by-what-was-compared", "host/bake/bake_bias.cpp",
        "const double weight = mesh.samples / mesh.compared;", "const double weight = 1;",
        r"^BakeBias\."),
    Mutation(
        "sun-without-cosine", "host/points/measure_points.cpp",
        "double{suns[s].irradiance} *\n"
        "                           std::max(0.0, double{normals_[i].dot(suns[s].direction)});",
        "double{suns[s].irradiance};",
        r"^Suns\."),
    Mutation(
        "suns-without-disks", "host/points/sun_rays.cpp",
        "const double down = u * double{kSunSolidAngle}",
        "const double down = 0 * u * double{kSunSolidAngle}",
        r"^(Suns|SunRays)\."),
    Mutation(
        "chosen-suns-without-cosine", "host/points/sun_rays.cpp",
        "double{sun.irradiance} * std::max(0.0, double{normal.dot(sun.direction)});",
        "normal.dot(sun.direction) > 0 ? double{sun.irradiance} : 0.0;",
        r"^(SunRays|SunSampling)\."),
    Mutation(
        "footprint-of-one-sun", "host/points/sun_rays.cpp",
        "if (first == last || !(all > 0)) return kSunSolidAngle;",
        "return kSunSolidAngle;",
        r"^(SunRays|SunSampling)\."),
    Mutation(
        "standard-error-of-all-sets", "host/points/set_sums.hpp",
        "/ (sets_ - 1);",
        "/ sets_;",
        r"^SetSums\."),
    Mutation(
        "sky-of-the-wrong-strength", "host/scene/lights/sky.cpp",
        "value * pi * (top * top - bottom * bottom);",
        "value * 2 * pi * (top - bottom);",
        r"^(Points|PointTheory)\."),
    Mutation(
        "repeated-scenes-repeat-lights", "host/points/periodic.cpp",
        "        copy.light = -1;\n",
        "",
        r"^Periodic\."),
    Mutation(
        "mirrored-triangles-show-their-back-first", "host/points/point_sources.cpp",
        "Imath::M44d(instance.to_world).determinant() < 0 ? -1.0f : 1.0f;",
        "1.0f;",
        r"^PointSources\."),
    Mutation(
        "bake-chooses-the-darker-side", "host/bake/samples/value_sums.cpp",
        "return difference > 0 ? 1.0f : 0.0f;",
        "return difference < 0 ? 1.0f : 0.0f;",
        r"^(Bake|BakeClosedForm|ValueSums)\."),
    Mutation(
        "sides-of-leaves-by-their-number-of-samples", "host/bake/samples/value_sums.cpp",
        "  difference += back.mean() - front.mean();",
        "  difference += (back.mean() - front.mean()) * back.count();",
        r"^(Bake|ValueSums)\."),
    Mutation(
        "a-place-without-a-front-is-white", "host/bake/samples/value_sums.cpp",
        "    if (!is_sampled(i)) {  // without",
        "    if (of_place_[i].front.weight <= 0) {  // without",
        r"^(Bake|ValueSums)\."),
    Mutation(
        "vertices-of-other-primitives", "host/scene/gltf/vertices.cpp",
        "if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return {};",
        "return {};",
        r"^BakeCommand\."),
    Mutation(
        "bake-ignores-areas", "host/bake/samples/surface_samples.cpp",
        "sample.weight[k] = twice_area * barycentric[k];",
        "sample.weight[k] = barycentric[k];",
        r"^(SurfaceSamples|Bake|BakeClosedForm)\."),
    Mutation(
        "enclosed-vertices-get-a-sum", "host/bake/vertex_bake.cpp",
        "ao[enclosed.group] = sum(ao, 0.0f) / count;",
        "ao[enclosed.group] = sum(ao, 0.0f);",
        r"^(Bake|BakeClosedForm)\."),
    Mutation(
        "primitives-share-values-that-differ", "host/commands/bake/file_values.cpp",
        "if (set.ao[at] != ao_[i] ||",
        "if (set.ao[at] < 0 ||",
        r"^BakeCommand\.(Sides|Meshes)"),
    Mutation(
        "borders-have-the-last-mesh", "host/bake/mesh_borders.cpp",
        "ao_ += baked.ao[vertex];",
        "ao_ = static_cast<float>(count_) * baked.ao[vertex];",
        r"^MeshBorders\."),
    Mutation(
        "hard-edges-between-meshes-are-joined", "host/bake/mesh_borders.cpp",
        "const VertexGroups groups = group_vertices(around.mesh, around.two_sided);",
        "VertexGroups groups = group_vertices(around.mesh, around.two_sided);\n"
        "  groups.of_vertex = places_of_vertices(around.mesh);\n"
        "  groups.count = groups.of_vertex.size();",
        r"^MeshBorders\."),
    Mutation(
        "unseen-texels-keep-their-colour", "host/device/upload/color_upload.cpp",
        "if (!levels.empty() && !is_seen(texture, weights, i))",
        "if (levels.empty() && !is_seen(texture, weights, i))",
        r"^Albedo\."),
    Mutation(
        "dilation-from-the-farthest-texel", "host/bake/texture/dilation.cpp",
        "square(source, u, v) < square(nearest[to], u, v)",
        "square(source, u, v) > square(nearest[to], u, v)",
        r"^Dilation\."),
    Mutation(
        "variance-of-bakes-by-one-interval", "host/bake/samples/pooled_variance.cpp",
        "kWeights{1, 0.5, 0.25}",
        "kWeights{1, 0, 0}",
        r"^BakeTarget\."),
    Mutation(
        "errors-of-bakes-by-their-samples-alone", "host/bake/samples/error_check.cpp",
        "fit.ratio = static_cast<float>((squares + prior) / (all.told + prior));",
        "fit.ratio = static_cast<float>((all.told + prior) / (all.told + prior));",
        r"^BakeTarget\."),
    Mutation(
        "errors-of-bakes-without-lost-contrast", "host/bake/samples/error_check.cpp",
        "all.squares + c * c * all.own + (1 - 2 * c) * all.cross;",
        "all.squares + c * c * (all.own - all.cross);",
        r"^BakeTarget\."),
    Mutation(
        "bent-normals-count-by-scale", "host/bake/samples/sample_tracer.cpp",
        "values[i].bent.normalized() * traced.bent[k].length();",
        "values[i].bent;",
        r"^MeshPlacements\."),
    Mutation(
        "dark-values-taken-for-enclosed", "host/bake/samples/value_sums.cpp",
        "if (is_dark(i) && has_inside(i)) continue;",
        "if (is_dark(i)) continue;",
        r"^InsideSamples\."),
    Mutation(
        "values-of-a-point-independent", "host/points/bias_correction.cpp",
        "between += of_point.sum * of_point.sum;",
        "between += of_point.squares;",
        r"^BiasCorrection\."),
    Mutation(
        "enclosed-texels-stay-black", "host/bake/texture/texture_bake.cpp",
        "nearest_valid(known_, texture_.size, all, covered_)",
        "nearest_valid(known_, texture_.size, 0 * all, covered_)",
        r"^BakeTexture\."),
    Mutation(
        "rays-of-bakes-forget-the-terms-of-sums", "host/render/queries/shared_points.cpp",
        "kTermsOfReach * reach[axis]",
        "0.0f * reach[axis]",
        r"^BakeSampleOrigin\."),
    Mutation(
        "seams-do-not-turn-edges", "host/bake/texture/seams.cpp",
        "  if (edge.swapped) return {second, first};\n  return {first, second};",
        "  return {first, second};",
        r"^Seams\."),
    Mutation(
        "instances-bake-the-darker-side", "host/bake/instance_bake.cpp",
        "const bool behind = found.back[s].scalar > found.front[s].scalar;",
        "const bool behind = found.back[s].scalar < found.front[s].scalar;",
        r"^BakeLight\."),
    Mutation(
        "baked-irradiance-of-both-sides-adds", "host/bake/samples/value_sums.cpp",
        "front_light_[at] * ((1 - share) / of_place_",
        "front_light_[at] * (1 / of_place_",
        r"^BakeLight\."),
    Mutation(
        "compare-overlooks-a-nan", "host/compare/difference.cpp",
        "} else if (std::isnan(a) || std::isnan(b)) {",
        "} else if (std::isnan(a) && std::isnan(b)) {",
        r"^(CompareLayers|CompareFailure|CompareFigures)\."),
    Mutation(
        "points-on-large-triangles", "host/points/point_sources.cpp",
        "normal * offset_above_plane(triangle.reach, normal)",
        "normal * 0.0f",
        r"^PointSources\."),
    Mutation(
        "pictures-that-are-not-centred", "host/scene/framing.cpp",
        "wide *= none / (none - has);",
        "wide *= 1.0f;",
        r"^FrameScene\."),
    Mutation(
        "backs-forget-earlier-slices", "host/passes/back_pass.cpp",
        "  packed.sample_count = choice.slots;",
        "  packed.first_sample = 0;\n  packed.sample_count = choice.slots;",
        r"^SliceSums\."),
    Mutation(
        "exposure-of-all-alike", "host/film/preview/tone_map.cpp",
        "const double off = (static_cast<double>(i) + 0.5) / std::max(size, 1) - 0.5;",
        "const double off = 0.0 * static_cast<double>(i);",
        r"^Png\."),
    Mutation(
        "mirrored-meshes-are-inside-out", "host/scene/merge.cpp",
        "if (mesh.has_strands() || Imath::M44d(to_world).determinant() >= 0) return;",
        "if (mesh.has_strands() || Imath::M44d(to_world).determinant() < 0) return;",
        r"^(Merge|InsideSamples)\."),
    Mutation(
        "smooth-points-move-through-surfaces", "host/render/queries/free_shifts.cpp",
        "if (found[k].transmittance < kFree)",
        "if (found[k].transmittance < 0)",
        r"^SmoothBake\."),
    Mutation(
        "bent-normals-of-both-sides-cancel", "host/bake/samples/value_sums.cpp",
        "constexpr float kLeast = 0.2f;",
        "constexpr float kLeast = 0.0f;",
        r"^ValueSums\."),
    Mutation(
        "sky-starts-off-the-vertical", "host/points/measure_points.cpp",
        "query.surfaces = normals_;",
        "query.surfaces = up;",
        r"^Undersides\."),
    Mutation(
        "rings-start-off-the-vertical", "host/points/ring_rays.cpp",
        "rays[i] = point_ray(point, normal,",
        "rays[i] = point_ray(point, V3f(0, 1, 0) + normal * 0.0f,",
        r"^Undersides\."),
]
