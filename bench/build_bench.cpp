// Building on the host, by wall time, and what the result weighs.
#include <benchmark/benchmark.h>

#include <chrono>

#include "benchmarks.hpp"

namespace dapple::bench {
namespace {

constexpr int kRepetitions = 5;

template <class T>
double bytes(const std::vector<T>& data) {
  return static_cast<double>(data.size() * sizeof(T));
}

/// Bytes a distinct triangle: of nodes, and of everything a ray may touch but textures.
void count_bytes(benchmark::State& state, const SceneBvh& bvh) {
  const auto triangles = static_cast<double>(bvh.statistics.triangles);
  const double all =
      bytes(bvh.nodes) + bytes(bvh.blocks) + bytes(bvh.textured) + bytes(bvh.instances);
  state.counters["triangles"] = triangles;
  state.counters["nodeB/tri"] = bytes(bvh.nodes) / triangles;
  state.counters["allB/tri"] = all / triangles;
}

void count_triangle_rate(benchmark::State& state, const SceneBvh& bvh) {
  const auto done = bvh.statistics.triangles * static_cast<std::size_t>(state.iterations());
  state.counters["tri"] =
      benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate);
}

void measure_build(benchmark::State& state, const Scene& scene) {
  SceneBvh bvh;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    bvh = build_bvh(scene);
    state.SetIterationTime(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  count_triangle_rate(state, bvh);
  count_bytes(state, bvh);
}

/// The opacities need a tree to go up, so each iteration builds one that is not counted.
void measure_prefilter(benchmark::State& state, const Scene& scene) {
  SceneBvh bvh;
  for (auto _ : state) {
    bvh = build_bvh(scene);
    state.SetIterationTime(bvh.statistics.prefilter_seconds);
  }
  count_triangle_rate(state, bvh);
}

template <class Measure>
void register_building(const std::string& kind, BenchScene& scene, const Measure& run) {
  const std::string name = kind + "/" + scene.name();
  benchmark::RegisterBenchmark(
      name.c_str(), [&scene, run](benchmark::State& state) { run(state, scene.scene()); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1)
      ->Repetitions(kRepetitions)
      ->DisplayAggregatesOnly();
}

}  // namespace

void register_build(BenchScene& scene) {
  register_building("Build", scene, measure_build);
  register_building("Prefilter", scene, measure_prefilter);
}

}  // namespace dapple::bench
