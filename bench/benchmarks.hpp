// What is measured of a scene; each function registers benchmarks named KIND/scene that
// live as long as `scene` does.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "bench_scene.hpp"

namespace dapple::bench {

/// Registers a benchmark: `measure`(benchmark::State&) runs once in each of `repetitions` and
/// sets the time itself.
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

/// Occlusion, OcclusionTogether, OcclusionOfPoints, each exact and prefiltered: AO rays one by one,
/// with their neighbours, with those of their point. Camera: the camera pass.
void register_tracing(BenchScene& scene);
/// Build: all of build_bvh(). Prefilter: the part of it that makes opacities.
void register_building(BenchScene& scene);
/// Refit: UpdatableBvh::update() of trees of 40 k to 4 M triangles, each frame of which is built
/// too.
void register_refitting();

}  // namespace dapple::bench
