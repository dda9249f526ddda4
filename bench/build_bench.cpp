// Building on the host, by wall time, and the bytes of the result.
#include <benchmark/benchmark.h>

#include <chrono>

#include "benchmarks.hpp"

namespace dapple::bench {
namespace {

constexpr int kRepetitions = 5;

template <class Array>
double bytes(const Array& data) {
  return static_cast<double>(data.size() * sizeof(data[0]));
}

/// Triangles and segments a second, and bytes a distinct one: of nodes, and of everything that a
/// ray may touch but texels.
void count_triangles(benchmark::State& state, const SceneBvh& bvh) {
  const auto triangles = static_cast<double>(bvh.statistics.triangles + bvh.statistics.segments);
  const double all = bytes(bvh.nodes) + bytes(bvh.blocks) + bytes(bvh.segments) +
                     bytes(bvh.textured) + bytes(bvh.instances);
  state.counters["tri"] = benchmark::Counter(triangles * static_cast<double>(state.iterations()),
                                             benchmark::Counter::kIsRate);
  state.counters["triangles"] = triangles;
  state.counters["nodeB/tri"] = bytes(bvh.nodes) / triangles;
  state.counters["allB/tri"] = all / triangles;
}

void measure_build(benchmark::State& state, const Scene& scene) {
  SceneBvh bvh;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    bvh = build_bvh(scene);
    state.SetIterationTime(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  count_triangles(state, bvh);
}

/// The opacities need a tree to go up, so each iteration builds one that is not counted.
void measure_prefilter(benchmark::State& state, const Scene& scene) {
  SceneBvh bvh;
  for (auto _ : state) {
    bvh = build_bvh(scene);
    state.SetIterationTime(bvh.statistics.prefilter_seconds);
  }
  count_triangles(state, bvh);
}

template <class Measure>
void add(const std::string& kind, BenchScene& scene, const Measure& measure) {
  register_measured(kind + "/" + scene.name(), kRepetitions,
                    [&scene, measure](benchmark::State& state) { measure(state, scene.scene()); });
}

}  // namespace

void register_building(BenchScene& scene) {
  add("Build", scene, measure_build);
  add("Prefilter", scene, measure_prefilter);
}

}  // namespace dapple::bench
