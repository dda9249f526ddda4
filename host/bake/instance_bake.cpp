#include "bake/instance_bake.hpp"

#include <algorithm>
#include <cmath>

#include "bake/vertex_bake.hpp"

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
  for (int i = 0; i < kInstanceSamples && area > 0; ++i) {
    const double at = (i + 0.5) / kInstanceSamples * area;
    const auto t =
        static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), at) - sums.begin());
    if (has_area(mesh, t)) samples.push_back(sample_triangle(mesh, t, none, two_sided[t], 0));
  }
  return samples;
}

/// The value of a sample as an instance's mean takes it.
float sample_value(const SurfaceSample& sample, const SideValue& front, const SideValue& back,
                   BakeSides sides) {
  if (!sample.back) return front.ao;
  return sides == BakeSides::mean ? 0.5f * (front.ao + back.ao) : std::max(front.ao, back.ao);
}

/// A flat list of samples of consecutive instances.
struct InstanceSlice {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement, instance;
  Placements placements;
};

}  // namespace

std::optional<std::vector<float>> bake_instances(const Scene& scene, const BakeOptions& options,
                                                 SampleTracer& tracer, BakeProgress& progress) {
  std::vector<std::vector<SurfaceSample>> of_mesh(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (!scene.meshes[m].has_strands())
      of_mesh[m] = samples_by_area(scene, scene.meshes[m], options);
  const int rays = std::min(options.rays, kInstanceRays);
  std::vector<double> sums(scene.instances.size()), counts(scene.instances.size());
  InstanceSlice slice;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    for (const SurfaceSample& sample : of_mesh[scene.instances[i].mesh]) {
      slice.samples.push_back(sample);
      slice.placement.push_back(static_cast<std::uint32_t>(slice.placements.to_world.size()));
      slice.instance.push_back(i);
    }
    slice.placements.add(scene.instances[i].to_world);
    const bool last = i + 1 == scene.instances.size();
    if ((slice.samples.size() < kSamplesAtOnce && !last) || slice.samples.empty()) continue;
    const TracedSamples found = tracer.trace(slice.samples, slice.placement, slice.placements, rays,
                                             hash_of(options.seed, ~i));
    for (std::size_t s = 0; s < slice.samples.size(); ++s) {
      sums[slice.instance[s]] +=
          double{sample_value(slice.samples[s], found.front[s], found.back[s], options.sides)};
      ++counts[slice.instance[s]];
    }
    if (!progress.add(slice.samples.size())) return {};
    slice = {};
  }
  std::vector<float> ao(sums.size(), 1.0f);
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (counts[i] > 0) ao[i] = static_cast<float>(sums[i] / counts[i]);
  return ao;
}

}  // namespace dapple
