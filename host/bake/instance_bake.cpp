#include "bake/instance_bake.hpp"

#include <algorithm>
#include <cmath>

#include "bake/vertex_bake.hpp"
#include "scene/invertible.hpp"

namespace dapple {
namespace {

/// Samples that are traced between two questions whether to stop.
constexpr std::size_t kSamplesAtOnce = 1u << 16;

/// The centres of triangles of a mesh, each triangle as often as its share of the area says.
std::vector<SurfaceSample> samples_by_area(const Scene& scene, const Mesh& mesh,
                                           const BakeOptions& options) {
  const std::vector<bool> two_sided = two_sided_triangles(scene, mesh, options.sides);
  std::vector<double> sums(mesh.primitive_count());
  double area = 0;
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const double part = double{area_vector(mesh, t).length()};
    sums[t] = area += std::isfinite(part) ? part : 0.0;
  }
  std::vector<SurfaceSample> samples;
  const VertexGroups none{std::vector<std::uint32_t>(mesh.positions.size()), 0};
  const SampledTriangles triangles{mesh, none, two_sided, options.normals};
  for (int i = 0; i < kInstanceSamples && area > 0; ++i) {
    const double at = (i + 0.5) / kInstanceSamples * area;
    const auto t =
        static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), at) - sums.begin());
    if (has_area(mesh, t)) samples.push_back(sample_triangle(triangles, t, 0));
  }
  return samples;
}

/// A flat list of samples of consecutive instances.
struct InstanceSlice {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement, instance;
  Placements placements;
};

/// Sums over the samples of each instance.
struct InstanceSums {
  std::vector<double> scalar, count;
  std::vector<std::vector<V3f>> light;

  InstanceSums(std::size_t instances, std::size_t lights)
      : scalar(instances), count(instances), light(lights, std::vector<V3f>(instances, V3f(0))) {}

  /// Of a two-sided sample the brighter side, or the mean.
  void add(const InstanceSlice& slice, const TracedSamples& found, BakeSides sides) {
    for (std::size_t s = 0; s < slice.samples.size(); ++s) {
      float front = 1, back = 0;
      if (slice.samples[s].back) {
        const bool behind = found.back[s].scalar > found.front[s].scalar;
        back = sides == BakeSides::mean ? 0.5f : behind ? 1.0f : 0.0f;
        front = 1 - back;
      }
      const std::uint32_t i = slice.instance[s];
      scalar[i] += double{front * found.front[s].scalar + back * found.back[s].scalar};
      ++count[i];
      for (std::size_t l = 0; l < light.size(); ++l)
        light[l][i] += found.front_light[s * light.size() + l] * front +
                       found.back_light[s * light.size() + l] * back;
    }
  }
};

/// The means of AO, or of lights. False: stopped.
bool trace_instances(const Scene& scene, const BakeOptions& options, BakeTracing& tracing,
                     bool lights, InstanceSums& sums) {
  std::vector<std::vector<SurfaceSample>> of_mesh(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (!scene.meshes[m].has_strands())
      of_mesh[m] = samples_by_area(scene, scene.meshes[m], options);
  const int rays = lights ? options.light_rays : std::min(options.rays, kInstanceRays);
  const TraceSamples& trace = lights ? tracing.light : tracing.ao;
  if (!tracing.progress.add(0)) return false;
  InstanceSlice slice;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const bool is_placed = is_invertible(scene.instances[i].to_world);
    for (const SurfaceSample& sample : of_mesh[scene.instances[i].mesh]) {
      if (!is_placed) break;
      slice.samples.push_back(sample);
      slice.placement.push_back(static_cast<std::uint32_t>(slice.placements.to_world.size()));
      slice.instance.push_back(i);
    }
    slice.placements.add(scene.instances[i].to_world);
    const bool last = i + 1 == scene.instances.size();
    if ((slice.samples.size() < kSamplesAtOnce && !last) || slice.samples.empty()) continue;
    const TracedSamples found = trace(slice.samples, slice.placement, slice.placements, rays,
                                      hash_of(options.seed, lights ? i ^ 0x55555555u : ~i));
    sums.add(slice, found, options.sides);
    tracing.statistics.points += found.points;
    tracing.statistics.rays += found.rays;
    if (!tracing.progress.add(slice.samples.size())) return false;
    slice = {};
  }
  tracing.progress.show();
  return true;
}

}  // namespace

std::optional<InstanceValues> bake_instances(const Scene& scene, const BakeOptions& options,
                                             BakeTracing& tracing) {
  const std::size_t count = scene.instances.size();
  InstanceSums ao(count, 0), light(count, tracing.lights);
  if (!trace_instances(scene, options, tracing, false, ao)) return {};
  if (tracing.light && !trace_instances(scene, options, tracing, true, light)) return {};
  tracing.statistics.instances = static_cast<std::size_t>(
      std::count_if(scene.instances.begin(), scene.instances.end(),
                    [](const Instance& instance) { return is_invertible(instance.to_world); }));
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.has_strands()) tracing.statistics.triangles += mesh.primitive_count();
  InstanceValues values{std::vector<float>(count, 1.0f), std::move(light.light)};
  for (std::size_t i = 0; i < count; ++i) {
    if (!(ao.count[i] > 0)) continue;
    values.ao[i] = static_cast<float>(ao.scalar[i] / ao.count[i]);
    for (std::vector<V3f>& of_light : values.light) of_light[i] /= static_cast<float>(ao.count[i]);
  }
  return values;
}

}  // namespace dapple
