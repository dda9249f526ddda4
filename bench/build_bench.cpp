// Measures build_bvh() on the host. In: scenes. Out: wall times and the size of the BVH.
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

/// Reports triangles and segments a second, and bytes for each distinct one: of nodes, and of all
/// arrays that rays read except texels.
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

/// Opacities are computed for a finished BVH, so each iteration builds one. The time is only that
/// of the opacities.
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
