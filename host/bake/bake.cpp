// bake(): scene and options in, values at vertices and instances out. Read it from bottom to top.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "bake/occluder_scene.hpp"
#include "bake/vertex_values.hpp"
#include "dapple/error.hpp"
#include "render/point_occlusion.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

/// Samples that are traced between two questions whether to stop: some tenths of a second.
constexpr std::size_t kSamplesAtOnce = 1u << 16;

/// Samples of an instance whose mean is its value.
constexpr int kInstanceSamples = 16;

/// Adds up what is traced, for progress and statistics.
class Work {
 public:
  Work(double samples, const RenderControl& control) : total_(samples), control_(control) {}

  /// False if the bake is to stop.
  bool add(std::size_t samples) {
    done_ += static_cast<double>(samples);
    if (control_.progress) control_.progress(std::min(1.0, done_ / std::max(1.0, total_)));
    return !(control_.stop && control_.stop());
  }

 private:
  double total_, done_ = 0;
  const RenderControl& control_;
};

/// One side of some samples in the world.
struct WorldPoints {
  std::vector<V3f> positions, normals;
};

V3f unit_normal(const V3f& normal, const M44f& inverse) {
  V3f out;
  inverse.transposed().multDirMatrix(normal, out);
  return out.normalized();
}

/// Placements of a mesh: their matrices and the inverses.
struct Placements {
  std::vector<M44f> to_world, to_object;
  [[nodiscard]] std::size_t of(std::uint32_t hash) const { return hash % to_world.size(); }
};

/// Traces samples from both sides.
class SampleTracer {
 public:
  SampleTracer(const OccluderScene& occluders, const BakeOptions& options,
               BakeStatistics& statistics)
      : occluders_(occluders), options_(options), statistics_(statistics) {}

  struct Found {
    std::vector<SideValue> front, back;  ///< back: zero for samples with one side
  };

  /// `placement`: of each sample, index into `placements`.
  Found trace(std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
              const Placements& placements, int rays, std::uint32_t hash) {
    Found found{side(samples, placement, placements, rays, hash, false), {}};
    const bool any_back = std::any_of(samples.begin(), samples.end(),
                                      [](const SurfaceSample& s) { return s.two_sided; });
    found.back = any_back ? side(samples, placement, placements, rays, hash_of(hash, 1), true)
                          : std::vector<SideValue>(samples.size());
    return found;
  }

 private:
  std::vector<SideValue> side(std::span<const SurfaceSample> samples,
                              std::span<const std::uint32_t> placement,
                              const Placements& placements, int rays, std::uint32_t hash,
                              bool back) {
    WorldPoints points;
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      if (back && !samples[i].two_sided) continue;
      const std::size_t at = placement[i];
      chosen.push_back(i);
      points.positions.push_back(samples[i].position * placements.to_world[at]);
      const V3f normal = unit_normal(samples[i].normal, placements.to_object[at]);
      points.normals.push_back(back ? -normal : normal);
    }
    OcclusionOptions options;
    options.rays = rays;
    options.estimator = options_.estimator;
    options.footprint = options_.footprint;
    options.distance = options_.distance;
    options.falloff = options_.falloff;
    options.seed = hash_of(options_.seed, hash);
    const PointOcclusion traced =
        point_occlusion(occluders_.device, occluders_.uploaded, points.positions, points.normals,
                        options, options_.bent);
    statistics_.points += chosen.size();
    statistics_.rays += chosen.size() * static_cast<std::uint64_t>(rays);
    std::vector<SideValue> values(samples.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      SideValue& value = values[chosen[k]];
      value.ao = traced.ao[k];
      if (options_.bent)
        placements.to_object[placement[chosen[k]]].multDirMatrix(traced.bent[k], value.bent);
    }
    return values;
  }

  const OccluderScene& occluders_;
  const BakeOptions& options_;
  BakeStatistics& statistics_;
};

/// Number of samples and rays for the triangles of a mesh.
struct MeshPlan {
  std::vector<bool> two_sided;  ///< by triangle
  bool any_two_sided = false;
};

MeshPlan plan_mesh(const Scene& scene, const Mesh& mesh, BakeSides sides) {
  MeshPlan plan;
  plan.two_sided.resize(mesh.primitive_count());
  for (std::size_t t = 0; t < plan.two_sided.size(); ++t)
    plan.two_sided[t] = is_two_sided(scene.materials[mesh.materials[t]], sides);
  plan.any_two_sided =
      std::find(plan.two_sided.begin(), plan.two_sided.end(), true) != plan.two_sided.end();
  return plan;
}

/// The values of one mesh's vertices; nothing if interrupted.
std::optional<BakedMesh> bake_mesh(const Mesh& mesh, const MeshPlan& plan, std::uint32_t index,
                                   const Placements& placements, const BakeOptions& options,
                                   SampleTracer& tracer, Work& work, BakeStatistics& statistics) {
  const VertexGroups groups = group_vertices(mesh, plan.any_two_sided);
  VertexValues values(mesh, groups, options.sides);
  const std::uint32_t mesh_hash = hash_of(options.seed, index);
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement;
  const SampleCounts counts =
      options.at_vertices ? SampleCounts{1, options.rays} : sample_counts(options.rays);
  const auto flush = [&](std::uint32_t hash) {
    placement.clear();
    for (std::size_t i = 0; i < samples.size(); ++i)
      placement.push_back(
          static_cast<std::uint32_t>(placements.of(hash_of(hash, static_cast<std::uint32_t>(i)))));
    const auto found = tracer.trace(samples, placement, placements, counts.rays, hash);
    for (std::size_t i = 0; i < samples.size(); ++i)
      values.add(samples[i], found.front[i], found.back[i]);
    const bool go_on = work.add(samples.size());
    samples.clear();
    return go_on;
  };
  if (options.at_vertices) {
    samples = sample_vertices(mesh, groups, plan.two_sided);
    if (!samples.empty() && !flush(mesh_hash)) return {};
  }
  for (std::size_t t = 0; t < mesh.primitive_count() && !options.at_vertices; ++t) {
    sample_triangle(mesh, t, groups, plan.two_sided[t], counts.points, samples);
    const bool last = t + 1 == mesh.primitive_count();
    if ((samples.size() < kSamplesAtOnce && !last) || samples.empty()) continue;
    if (!flush(hash_of(mesh_hash, ~static_cast<std::uint32_t>(t)))) return {};
  }
  statistics.vertices += mesh.positions.size();
  statistics.triangles += mesh.primitive_count();
  return values.finish(options.bent, statistics.hidden_vertices);
}

Placements placements_of(const Scene& scene, std::uint32_t mesh, BakeInstances kind) {
  Placements placements;
  const auto add = [&](const M44f& matrix) {
    placements.to_world.push_back(matrix);
    placements.to_object.push_back(matrix.inverse());
  };
  if (kind == BakeInstances::alone) {
    add(M44f());
    return placements;
  }
  for (const Instance& instance : scene.instances)
    if (instance.mesh == mesh) add(instance.to_world);
  return placements;
}

double samples_of(const Scene& scene, const BakeOptions& options) {
  double samples = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (!options.vertices || mesh.has_strands()) continue;
    samples += options.at_vertices ? static_cast<double>(mesh.positions.size())
                                   : static_cast<double>(mesh.primitive_count()) *
                                         sample_counts(options.rays).points;
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
                   Work& work, BakeResult& result) {
  result.meshes.resize(scene.meshes.size());
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const Placements placements = placements_of(scene, m, options.placement);
    if (mesh.has_strands() || mesh.primitive_count() == 0 || placements.to_world.empty()) continue;
    std::optional<OccluderScene> alone;
    if (!together) alone.emplace(scene_of_mesh(scene, m), options, std::vector<Scene>{});
    SampleTracer tracer(together ? *together : *alone, options, result.statistics);
    auto baked = bake_mesh(mesh, plan_mesh(scene, mesh, options.sides), m, placements, options,
                           tracer, work, result.statistics);
    if (!baked) return false;
    result.meshes[m] = std::move(*baked);
  }
  return true;
}

/// Triangles of a mesh, each as often as its share of the area says.
std::vector<SurfaceSample> samples_by_area(const Scene& scene, const Mesh& mesh,
                                           const BakeOptions& options) {
  const MeshPlan plan = plan_mesh(scene, mesh, options.sides);
  std::vector<double> sums(mesh.primitive_count());
  double area = 0;
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const double part = area_vector(mesh, t).length();
    sums[t] = area += std::isfinite(part) ? part : 0.0;
  }
  std::vector<SurfaceSample> samples;
  const VertexGroups none{std::vector<std::uint32_t>(mesh.positions.size()), 0};
  for (int i = 0; i < kInstanceSamples && area > 0; ++i) {
    const double at = (i + 0.5) / kInstanceSamples * area;
    const auto t = std::lower_bound(sums.begin(), sums.end(), at) - sums.begin();
    sample_triangle(mesh, static_cast<std::size_t>(t), none,
                    plan.two_sided[static_cast<std::size_t>(t)], 1, samples);
  }
  return samples;
}

/// The value of a sample as an instance's mean takes it.
float sample_value(const SurfaceSample& sample, const SideValue& front, const SideValue& back,
                   BakeSides sides) {
  if (!sample.two_sided) return front.ao;
  return sides == BakeSides::mean ? 0.5f * (front.ao + back.ao) : std::max(front.ao, back.ao);
}

/// A flat list of samples of consecutive instances.
struct InstanceSlice {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement, instance;
  Placements placements;
};

bool bake_instances(const Scene& scene, const BakeOptions& options, const OccluderScene& occluders,
                    Work& work, BakeResult& result) {
  std::vector<std::vector<SurfaceSample>> of_mesh(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (!scene.meshes[m].has_strands())
      of_mesh[m] = samples_by_area(scene, scene.meshes[m], options);
  SampleTracer tracer(occluders, options, result.statistics);
  std::vector<double> sums(scene.instances.size()), counts(scene.instances.size());
  InstanceSlice slice;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    for (const SurfaceSample& sample : of_mesh[scene.instances[i].mesh]) {
      slice.samples.push_back(sample);
      slice.placement.push_back(static_cast<std::uint32_t>(slice.placements.to_world.size()));
      slice.instance.push_back(i);
    }
    slice.placements.to_world.push_back(scene.instances[i].to_world);
    slice.placements.to_object.push_back(scene.instances[i].to_world.inverse());
    const bool last = i + 1 == scene.instances.size();
    if ((slice.samples.size() < kSamplesAtOnce && !last) || slice.samples.empty()) continue;
    const auto found = tracer.trace(slice.samples, slice.placement, slice.placements, options.rays,
                                    hash_of(options.seed, ~i));
    for (std::size_t s = 0; s < slice.samples.size(); ++s) {
      sums[slice.instance[s]] +=
          double{sample_value(slice.samples[s], found.front[s], found.back[s], options.sides)};
      ++counts[slice.instance[s]];
    }
    if (!work.add(slice.samples.size())) return false;
    slice = {};
  }
  result.instance_ao.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    result.instance_ao[i] = counts[i] > 0 ? static_cast<float>(sums[i] / counts[i]) : 1.0f;
  return true;
}

}  // namespace

void validate(const BakeOptions& options) {
  const auto check = [](const char* flag, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw Error(ErrorKind::usage,
                fmt::format("{} is {}; it must be from {} to {}", flag, value, low, high));
  };
  check("--rays", options.rays, 16, 65536);
  check("--footprint", static_cast<double>(options.footprint), 0, 1e6);
  check("--ao-distance", static_cast<double>(options.distance), 0, 1e30);
  check("--ao-falloff", static_cast<double>(options.falloff), 0, 100);
}

BakeResult bake(const Scene& scene, const BakeOptions& options, const RenderControl& control,
                const std::vector<Scene>& occluders) {
  validate(options);
  const Stopwatch total;
  BakeResult result;
  BakeStatistics& s = result.statistics;
  std::optional<OccluderScene> together;
  if (options.placement == BakeInstances::together || options.instances) {
    together.emplace(scene, options, occluders);
    s.seconds.build = together->build_seconds;
    s.seconds.upload = together->upload_seconds;
    s.device = together->device.info().name;
    s.notes = together->notes;
  }
  Work work(samples_of(scene, options), control);
  const Stopwatch tracing;
  const bool alone = options.placement == BakeInstances::alone;
  bool complete = true;
  if (options.vertices)
    complete = bake_vertices(scene, options, alone ? nullptr : &*together, work, result);
  if (complete && options.instances)
    complete = bake_instances(scene, options, *together, work, result);
  result.interrupted = !complete;
  s.seconds.trace = tracing.seconds();
  s.seconds.total = total.seconds();
  return result;
}

}  // namespace dapple
