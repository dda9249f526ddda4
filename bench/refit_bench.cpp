// Compares refitting with building, for botanical trees in the wind of several sizes. In:
// procedural scenes. Out: wall times of both, measured alternately.
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>

#include "benchmarks.hpp"
#include "support/scenes/swaying_tree.hpp"

namespace dapple::bench {
namespace {

constexpr int kRepetitions = 5;

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Frames are 1/24 s apart. The measured time is that of refitting; a counter has the time of
/// building the same frame.
void measure_refit(benchmark::State& state, const std::string& spec) {
  Scene still = make_procedural(spec);
  merge_single_instances(still);
  UpdatableBvh updatable(still);
  updatable.update(motion::swayed(still, 0.9f));
  double refit = 0, build = 0;
  int frame = 0;
  for (auto _ : state) {
    const Scene moved = motion::swayed(still, 1 + static_cast<float>(frame++) / 24);
    const double seconds = seconds_of([&] { updatable.update(moved); });
    state.SetIterationTime(seconds);
    refit += seconds;
    build += seconds_of([&] { benchmark::DoNotOptimize(build_bvh(moved)); });
  }
  const auto triangles = static_cast<double>(updatable.bvh().statistics.triangles);
  const double frames = static_cast<double>(frame);
  state.counters["triangles"] = triangles;
  state.counters["build_ms"] = build / frames * 1e3;
  state.counters["refit/build"] = refit / build;
  state.counters["ns/tri"] = refit / frames / triangles * 1e9;
}

}  // namespace

void register_refitting() {
  for (const auto& [name, leaves] :
       {std::pair("40k", 16200), std::pair("200k", 96200), std::pair("1M", 496200),
        std::pair("2M", 996200), std::pair("4M", 1996200)}) {
    const std::string spec = "scene:tree?leaves=" + std::to_string(leaves);
    register_measured(std::string("Refit/tree-") + name, kRepetitions,
                      [spec](benchmark::State& state) { measure_refit(state, spec); });
  }
}

}  // namespace dapple::bench
