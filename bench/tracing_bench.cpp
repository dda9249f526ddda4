// The two traversal kernels, timed by the device's own clock: uploading rays and reading
// results back is not counted.
#include <benchmark/benchmark.h>

#include <map>

#include "benchmarks.hpp"
#include "dapple/wavefront.hpp"
#include "device/context.hpp"

namespace dapple::bench {
namespace {

constexpr int kIterations = 3;
constexpr int kRepetitions = 7;

/// Device seconds that passes called `label` took so far.
double seconds_of(const Device& device, const std::string& label) {
  const std::map<std::string, double>& passes = device.context().pass_seconds();
  const auto found = passes.find(label);
  return found == passes.end() ? 0.0 : found->second;
}

/// Mean node visits and triangle tests a ray, from results' packed `visits`.
template <class Result>
void count_work(benchmark::State& state, const std::vector<Result>& results) {
  double visits = 0, tests = 0;
  for (const Result& result : results) {
    visits += result.visits & 0xffffu;
    tests += result.visits >> 16;
  }
  const auto rays = static_cast<double>(results.size());
  state.counters["visits/ray"] = visits / rays;
  state.counters["tests/ray"] = tests / rays;
  state.counters["rays"] = benchmark::Counter(rays * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
}

/// Times `trace_all`, which launches passes called `label` and returns one result a ray.
template <class TraceAll>
void measure(benchmark::State& state, const Device& device, const std::string& label,
             const TraceAll& trace_all) {
  auto results = trace_all();  // compiles the kernel and warms the caches
  for (auto _ : state) {
    const double before = seconds_of(device, label);
    results = trace_all();
    state.SetIterationTime(seconds_of(device, label) - before);
  }
  count_work(state, results);
}

template <class Measure>
void register_tracing(const std::string& name, const Measure& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(kIterations)
      ->Repetitions(kRepetitions)
      ->DisplayAggregatesOnly();
}

void register_estimator(BenchScene& scene, const std::string& kind, Estimator estimator) {
  register_tracing(kind + "/" + scene.name(), [&scene, estimator](benchmark::State& state) {
    const SceneRays& rays = scene.rays();
    measure(state, scene.device(), "occlusion",
            [&] { return trace(scene.device(), scene.on_device(), rays.ao, estimator); });
  });
}

}  // namespace

void register_occlusion(BenchScene& scene) {
  register_estimator(scene, "Occlusion/exact", Estimator::exact);
  register_estimator(scene, "Occlusion/prefiltered", Estimator::prefiltered);
}

void register_closest_hit(BenchScene& scene) {
  register_tracing("ClosestHit/" + scene.name(), [&scene](benchmark::State& state) {
    const SceneRays& rays = scene.rays();
    measure(state, scene.device(), "closest hit",
            [&] { return closest_hits(scene.device(), scene.on_device(), rays.camera); });
  });
}

}  // namespace dapple::bench
