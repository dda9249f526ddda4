#include "rivals/bake_protocol.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>

#include "bake/surface_samples.hpp"
#include "bake/vertex_bake.hpp"

namespace dapple::bench {
namespace {

constexpr std::uint32_t kReferenceSeeds[2] = {0x7e000001u, 0x7e000002u};
constexpr double kFirstTarget = 0.32;
constexpr double kMaxEffort = 1024;

/// For each vertex group the triangles around it: [first[group], first[group + 1]) of `triangles`.
struct GroupTriangles {
  std::vector<std::uint32_t> first, triangles;

  GroupTriangles(const Mesh& mesh, const VertexGroups& groups)
      : first(groups.count + 1), triangles(mesh.indices.size()) {
    for (const std::uint32_t vertex : mesh.indices) ++first[groups.of_vertex[vertex] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < mesh.indices.size(); ++i)
      triangles[next[groups.of_vertex[mesh.indices[i]]]++] = i / 3;
  }
};

/// The triangles that affect the values of the `chosen` ones: those of the same small part, and
/// those that share a vertex. Sorted.
std::vector<std::uint32_t> with_neighbours(const Mesh& mesh, const VertexGroups& groups,
                                           const std::vector<std::uint32_t>& chosen) {
  const GroupTriangles around(mesh, groups);
  const std::vector<std::uint32_t> part = connected_parts(mesh, groups);
  std::vector<std::uint32_t> part_size(groups.count);
  for (const std::uint32_t p : part) ++part_size[p];
  std::vector<bool> taken(mesh.primitive_count());
  const auto take_around = [&](std::uint32_t group) {
    for (std::uint32_t i = around.first[group]; i < around.first[group + 1]; ++i)
      taken[around.triangles[i]] = true;
  };
  std::vector<bool> part_taken(groups.count);
  for (const std::uint32_t t : chosen) {
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
      take_around(groups.of_vertex[mesh.indices[i]]);
    const std::uint32_t p = part[groups.of_vertex[mesh.indices[3 * t]]];
    part_taken[p] = part_size[p] <= kSmallPart;
  }
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < taken.size(); ++t)
    if (taken[t] || part_taken[part[groups.of_vertex[mesh.indices[3 * t]]]]) triangles.push_back(t);
  return triangles;
}

BakedPart part_of(const Scene& scene, const Mesh& mesh, const std::vector<std::uint32_t>& chosen) {
  const std::vector<bool> two_sided = two_sided_triangles(scene, mesh, BakeSides::automatic);
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  BakedPart part;
  for (const std::uint32_t t : with_neighbours(mesh, group_vertices(mesh, two_sided), chosen)) {
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i) {
      std::uint32_t& vertex = number[mesh.indices[i]];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(part.mesh.positions.size());
        part.mesh.positions.push_back(mesh.positions[mesh.indices[i]]);
      }
      part.mesh.indices.push_back(vertex);
    }
    part.mesh.materials.push_back(mesh.materials[t]);
    part.two_sided.push_back(two_sided[t]);
  }
  for (const std::uint32_t t : chosen)
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
      part.compared.push_back(number[mesh.indices[i]]);
  std::sort(part.compared.begin(), part.compared.end());
  part.compared.erase(std::unique(part.compared.begin(), part.compared.end()), part.compared.end());
  return part;
}

std::vector<double> bake_parts(const std::vector<BakedPart>& parts, const TracePoints& trace,
                               const BakeOptions& options) {
  BakeStatistics statistics;
  const RenderControl control;
  BakeProgress progress(1, control);
  BakeTracing tracing{ao_tracer(trace, options), {}, 0, progress, statistics};
  std::vector<double> values;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    const BakedPart& part = parts[i];
    const auto baked = bake_mesh(part.mesh, part.two_sided, i, part.placements, options, tracing);
    for (const std::uint32_t vertex : part.compared) values.push_back(double{baked->ao[vertex]});
  }
  return values;
}

TracePoints by_embree(const RivalScene& scene, const EmbreeMethod& method, float black) {
  return [&scene, method, black](const QueryPoints& query, const OcclusionOptions& options, bool) {
    std::vector<Surface> points(query.positions.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = {query.positions[i], query.normals[i]};
    const std::vector<double> ao = embree_occlusion(
        scene.embree, method, points, static_cast<std::size_t>(options.rays), options.seed, black);
    return PointOcclusion{{ao.begin(), ao.end()}, {}};
  };
}

TracePoints by_dapple(const RivalScene& scene) {
  return [&scene](const QueryPoints& points, const OcclusionOptions& options, bool bent) {
    return point_occlusion(scene.device, scene.on_device, points, options, bent);
  };
}

BakeOptions with_rays(int rays, std::uint32_t seed) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = rays;
  options.estimator = Estimator::exact;
  options.seed = seed;
  return options;
}

/// Returns the options of a bake for an effort (1, 2, 4 and so on).
using OptionsOfEffort = std::function<BakeOptions(double)>;

/// Samples are added until the standard error of each value is at most 0.32 / sqrt(effort).
OptionsOfEffort to_target(Estimator estimator) {
  return [estimator](double effort) {
    BakeOptions options = with_rays(65536, 0);
    options.target_error = static_cast<float>(kFirstTarget / std::sqrt(effort));
    options.estimator = estimator;
    return options;
  };
}

/// The same number of rays for each side of every triangle.
BakeOptions uniformly(double effort) { return with_rays(kRaysPerSample * int(effort), 0); }

Contestant contestant(const std::string& name, bool is_embree, const OptionsOfEffort& options_of,
                      const std::vector<BakedPart>& parts, const TracePoints& trace) {
  const auto run = [&parts, trace, options_of](double effort, std::uint32_t seed) {
    BakeOptions options = options_of(effort);
    options.seed = seed;
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome;
    outcome.values = bake_parts(parts, trace, options);
    outcome.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return outcome;
  };
  std::vector<double> ladder;
  for (double effort = 1; effort <= kMaxEffort; effort *= 2) ladder.push_back(effort);
  // The maximum of two noisy sides is biased, so no contestant is expected to equal the truth.
  return {name, is_embree, false, ladder, run};
}

}  // namespace

std::vector<BakedPart> choose_parts(const Scene& scene, std::size_t triangles) {
  std::size_t all = 0;
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.has_strands()) all += mesh.primitive_count();
  const std::size_t count = std::min(triangles, all);
  std::vector<BakedPart> parts;
  std::size_t before = 0, next = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.has_strands()) continue;
    std::vector<std::uint32_t> chosen;
    for (; next < count && next * all / count < before + mesh.primitive_count(); ++next)
      chosen.push_back(static_cast<std::uint32_t>(next * all / count - before));
    before += mesh.primitive_count();
    BakedPart part;
    if (!chosen.empty()) part = part_of(scene, mesh, chosen);
    for (const Instance& instance : scene.instances)
      if (instance.mesh == m) part.placements.add(instance.to_world);
    if (!chosen.empty() && !part.placements.to_world.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

Truth bake_truth(const RivalScene& scene, const std::vector<BakedPart>& parts, int rays) {
  const auto half = [&](std::uint32_t seed) {
    return bake_parts(parts,
                      by_embree(scene, {Alpha::multiplicative, 1, false, false}, kReferenceBlack),
                      with_rays((rays + 1) / 2, seed));
  };
  return truth_of_halves(half(kReferenceSeeds[0]), half(kReferenceSeeds[1]));
}

std::vector<double> bake_exactly(const RivalScene& scene, const std::vector<BakedPart>& parts,
                                 int rays) {
  return bake_parts(parts, by_dapple(scene), with_rays(rays, 1));
}

std::vector<Contestant> bake_contestants(const RivalScene& scene,
                                         const std::vector<BakedPart>& parts,
                                         const std::vector<EmbreeMethod>& methods) {
  std::vector<Contestant> contestants;
  for (const EmbreeMethod& method : methods) {
    const TracePoints trace = by_embree(scene, method, kContestBlack);
    contestants.push_back(
        contestant("Embree " + method.name() + ", uniform", true, uniformly, parts, trace));
    contestants.push_back(contestant("Embree " + method.name() + ", dapple's samples", true,
                                     to_target(Estimator::exact), parts, trace));
  }
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered})
    contestants.push_back(contestant(estimator == Estimator::exact ? "exact" : "prefiltered", false,
                                     to_target(estimator), parts, by_dapple(scene)));
  return contestants;
}

}  // namespace dapple::bench
