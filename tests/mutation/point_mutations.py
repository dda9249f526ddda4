"""Bugs in what is baked and measured at points: host/bake, host/points."""

from mutation import Mutation

MUTATIONS = [
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
        "return {probability_above(-z),",
        "return {probability_above(z),",
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
        "errors-of-cards-by-their-own-samples", "host/bake/samples/value_sums.cpp",
        "const float left = contrast_ * contrast_;",
        "const float left = 1;",
        r"^ValueSums\."),
    Mutation(
        "the-brighter-side-is-always-known", "host/bake/samples/value_sums.cpp",
        " + choice_[i].regret / (scale() * scale());",
        ";",
        r"^ValueSums\."),
    Mutation(
        "the-darker-side-is-sampled-for-ever", "host/bake/samples/value_sums.cpp",
        "kToleratedRegret * target_error * target_error *",
        "0 * kToleratedRegret * target_error *",
        r"^ValueSums\."),
    Mutation(
        "bias-of-the-second-set", "host/bake/samples/sample_rounds.cpp",
        "traced(batch, trace_.of_check)",
        "traced(batch, trace_.values)",
        r"^BakeBias\."),
    Mutation(
        "few-blocked-rays-are-darkness", "host/bake/samples/value_sums.cpp",
        "const bool sees_nothing = is_dark(index) || is_inside(index);",
        "const bool sees_nothing = is_inside(index);",
        r"^ValueSums\."),
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
        "points-on-large-triangles", "host/points/point_sources.cpp",
        "normal * offset_above_plane(triangle.reach, normal)",
        "normal * 0.0f",
        r"^PointSources\."),
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
