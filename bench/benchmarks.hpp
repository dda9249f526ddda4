// Registers the benchmarks. In: a scene, which must outlive them; out: benchmarks with the names
// KIND/scene.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "bench_scene.hpp"

namespace dapple::bench {

/// Registers a benchmark. `measure`(benchmark::State&) runs once in each of `repetitions` and sets
/// the time itself.
template <class Measure>
void register_measured(const std::string& name, int repetitions, const Measure& measure) {
  benchmark::RegisterBenchmark(name.c_str(), measure)
      ->UseManualTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1)
      ->Repetitions(repetitions)
      ->DisplayAggregatesOnly();
}

/// Occlusion, OcclusionPixelPackets and OcclusionPointPackets, each exact and prefiltered: AO rays
/// as single rays, in pixel packets, and in point packets. DomeRays: generation of rays to a dome
/// light. Camera: the camera pass.
void register_tracing(BenchScene& scene);
/// Build: all of build_bvh(). Prefilter: the part of it that computes opacities.
void register_building(BenchScene& scene);
/// Layers: pictures at the defaults of `dapple render` with one more layer, and the ratio of
/// processor time to that without it.
void register_layers(const SceneRecipe& recipe);
/// Refit: UpdatableBvh::update() of moving trees of 40 k to 4 M triangles, compared with
/// build_bvh().
void register_refitting();

}  // namespace dapple::bench
