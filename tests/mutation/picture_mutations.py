"""Bugs in what happens to the rays of pictures: host/render, host/sampling, host/film, host/compare."""

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
        "sky-of-the-wrong-strength", "host/scene/lights/sky.cpp",
        "value * pi * (top * top - bottom * bottom);",
        "value * 2 * pi * (top - bottom);",
        r"^(Points|PointTheory)\."),
    Mutation(
        "vertices-of-other-primitives", "host/scene/gltf/vertices.cpp",
        "if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return {};",
        "return {};",
        r"^BakeCommand\."),
    Mutation(
        "primitives-share-values-that-differ", "host/commands/bake/file_values.cpp",
        "if (set.ao[at] != ao_[i] ||",
        "if (set.ao[at] < 0 ||",
        r"^BakeCommand\.(Sides|Meshes)"),
    Mutation(
        "unseen-texels-keep-their-colour", "host/device/upload/color_upload.cpp",
        "if (!levels.empty() && !is_seen(texture, weights, i))",
        "if (levels.empty() && !is_seen(texture, weights, i))",
        r"^Albedo\."),
    Mutation(
        "rays-of-bakes-forget-the-terms-of-sums", "host/render/queries/shared_points.cpp",
        "kTermsOfReach * reach[axis]",
        "0.0f * reach[axis]",
        r"^BakeSampleOrigin\."),
    Mutation(
        "compare-overlooks-a-nan", "host/compare/difference.cpp",
        "} else if (std::isnan(a) || std::isnan(b)) {",
        "} else if (std::isnan(a) && std::isnan(b)) {",
        r"^(CompareLayers|CompareFailure|CompareFigures)\."),
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
]
