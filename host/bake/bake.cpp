// bake(): scene and options in, values at vertices and instances out. Read it from bottom to top.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <optional>

#include "bake/instance_bake.hpp"
#include "bake/occluder_scene.hpp"
#include "bake/vertex_bake.hpp"
#include "dapple/error.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

/// Samples of a triangle that a target needs in the mean, for the first guess of the time left.
constexpr double kExpectedSamples = 4;

TracePoints trace_against(const OccluderScene& occluders) {
  return [&occluders](std::span<const V3f> positions, std::span<const V3f> normals,
                      const OcclusionOptions& options, bool bent) {
    return point_occlusion(occluders.device, occluders.uploaded, positions, normals, options, bent);
  };
}

Placements placements_of(const Scene& scene, std::uint32_t mesh, BakeInstances kind) {
  Placements placements;
  if (kind == BakeInstances::alone) {
    placements.add(M44f());
    return placements;
  }
  for (const Instance& instance : scene.instances)
    if (instance.mesh == mesh) placements.add(instance.to_world);
  return placements;
}

double expected_samples(const Scene& scene, const BakeOptions& options) {
  const double of_triangle = options.target_error > 0
                                 ? kExpectedSamples
                                 : double{1.0 * sample_counts(options.rays).samples};
  double samples = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (!options.vertices || mesh.has_strands()) continue;
    samples += options.at_vertices ? static_cast<double>(mesh.positions.size())
                                   : static_cast<double>(mesh.primitive_count()) * of_triangle;
  }
  if (options.instances) samples += static_cast<double>(scene.instances.size()) * kInstanceSamples;
  return samples;
}

/// The part of a scene that is one mesh, as it is in object space.
Scene scene_of_mesh(const Scene& scene, std::size_t mesh) {
  Scene alone;
  alone.source = scene.source;
  alone.textures = scene.textures;
  alone.materials = scene.materials;
  alone.meshes = {scene.meshes[mesh]};
  alone.instances.resize(1);
  return alone;
}

bool bake_vertices(const Scene& scene, const BakeOptions& options, const OccluderScene* together,
                   BakeProgress& progress, BakeResult& result) {
  result.meshes.resize(scene.meshes.size());
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const Placements placements = placements_of(scene, m, options.placement);
    if (mesh.has_strands() || mesh.primitive_count() == 0 || placements.to_world.empty()) continue;
    std::optional<OccluderScene> alone;
    if (!together) alone.emplace(scene_of_mesh(scene, m), options, std::vector<Scene>{});
    SampleTracer tracer(trace_against(together ? *together : *alone), options, result.statistics);
    auto baked = bake_mesh(mesh, two_sided_triangles(scene, mesh, options.sides), m, placements,
                           options, tracer, progress, result.statistics);
    if (!baked) return false;
    result.meshes[m] = std::move(*baked);
  }
  return true;
}

}  // namespace

void validate(const BakeOptions& options) {
  const auto check = [](const char* flag, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw Error(ErrorKind::usage,
                fmt::format("{} is {}; it must be from {} to {}", flag, value, low, high));
  };
  check("--rays", options.rays, kRaysPerSample, 65536);
  check("--target-error", double{options.target_error}, 0, 1);
  check("--footprint", double{options.footprint}, 0, 1e6);
  check("--ao-distance", double{options.distance}, 0, 1e30);
  check("--ao-falloff", double{options.falloff}, 0, 100);
}

BakeResult bake(const Scene& scene, const BakeOptions& options, const RenderControl& control,
                const std::vector<Scene>& occluders) {
  validate(options);
  const Stopwatch total;
  BakeResult result;
  BakeStatistics& s = result.statistics;
  const bool alone = options.placement == BakeInstances::alone;
  std::optional<OccluderScene> together;
  if (!alone || options.instances) {
    together.emplace(scene, options, occluders);
    s.seconds.build = together->build_seconds;
    s.seconds.upload = together->upload_seconds;
    s.device = together->device.info().name;
    s.notes = together->notes;
  }
  BakeProgress progress(expected_samples(scene, options), control);
  const Stopwatch tracing;
  if (options.vertices)
    result.interrupted =
        !bake_vertices(scene, options, alone ? nullptr : &*together, progress, result);
  if (options.instances && !result.interrupted) {
    SampleTracer tracer(trace_against(*together), options, s);
    auto values = bake_instances(scene, options, tracer, progress);
    result.interrupted = !values;
    if (values) result.instance_ao = std::move(*values);
  }
  s.seconds.trace = tracing.seconds();
  s.seconds.total = total.seconds();
  return result;
}

}  // namespace dapple
