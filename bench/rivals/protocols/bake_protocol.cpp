#include "rivals/protocols/bake_protocol.hpp"

#include <chrono>
#include <cmath>
#include <functional>

#include "bake/samples/surface_samples.hpp"
#include "bake/vertex_bake.hpp"

namespace dapple::bench {
namespace {

constexpr std::uint32_t kReferenceSeeds[2] = {0x7e000001u, 0x7e000002u};
constexpr double kFirstTarget = 0.32;
constexpr double kMaxEffort = 1024;

std::vector<double> bake_parts(const std::vector<BakedPart>& parts, const TracePoints& trace,
                               const BakeOptions& options) {
  BakeStatistics statistics;
  const RenderControl control;
  BakeProgress progress(1, control);
  const TraceSamples ao = ao_tracer(trace, options);
  BakeTracing tracing{{ao, ao}, {}, 0, progress, statistics};
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
