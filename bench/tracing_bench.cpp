// The two traversal kernels on rays that lie ready on the device, timed by its own clock.
#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "device/context.hpp"

namespace dapple::bench {
namespace {

constexpr const char* kLabel = "bench";
constexpr int kRepetitions = 9;

/// Device seconds of all launches so far.
double device_seconds(DeviceContext& context) {
  context.finish();
  double seconds = 0;
  for (const auto& [label, pass_seconds] : context.pass_seconds()) seconds += pass_seconds;
  return seconds;
}

/// Node visits and triangle tests a ray, from results' packed `visits`.
template <class Result>
void count_work(benchmark::State& state, DeviceContext& context, const Buffer& buffer,
                std::size_t rays) {
  std::vector<Result> results(rays);
  context.read(buffer, results.data(), rays * sizeof(Result));
  double visits = 0, tests = 0;
  for (const Result& result : results) {
    visits += result.visits & 0xffffu;
    tests += result.visits >> 16;
  }
  const auto count = static_cast<double>(rays);
  state.counters["visits/ray"] = visits / count;
  state.counters["tests/ray"] = tests / count;
  state.counters["rays"] = benchmark::Counter(count * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
}

/// Times `launch`, once unmeasured to compile its kernel and warm the caches.
template <class Launch>
void time_launches(benchmark::State& state, DeviceContext& context, const Launch& launch) {
  launch();
  double before = device_seconds(context);
  for (auto _ : state) {
    launch();
    const double after = device_seconds(context);
    state.SetIterationTime(after - before);
    before = after;
  }
}

void measure_occlusion(benchmark::State& state, BenchScene& scene, Estimator estimator) {
  const SceneRays& rays = scene.rays();
  const DeviceBuffers& buffers = *scene.on_device().buffers;
  DeviceContext& context = scene.device().context();
  OcclusionParams params{};
  params.scene = buffers.params;
  params.ray_count = static_cast<uint>(rays.ao_count);
  params.footprint = 1.0f;
  time_launches(state, context,
                [&] { occlusion_pass(context, rays.ao, buffers, kLabel, estimator, params); });
  count_work<Occlusion>(state, context, rays.ao.occlusions, rays.ao_count);
}

void measure_closest_hit(benchmark::State& state, BenchScene& scene) {
  const SceneRays& rays = scene.rays();
  const DeviceBuffers& buffers = *scene.on_device().buffers;
  DeviceContext& context = scene.device().context();
  time_launches(state, context,
                [&] { closest_hit_pass(context, buffers, rays.camera, rays.camera_count); });
  count_work<SurfacePoint>(state, context, rays.camera.points, rays.camera_count);
}

template <class Measure>
void add(const std::string& name, const Measure& measure) {
  benchmark::RegisterBenchmark(name.c_str(), measure)
      ->UseManualTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1)
      ->Repetitions(kRepetitions)
      ->DisplayAggregatesOnly();
}

}  // namespace

void register_tracing(BenchScene& scene) {
  add("Occlusion/exact/" + scene.name(),
      [&scene](benchmark::State& state) { measure_occlusion(state, scene, Estimator::exact); });
  add("Occlusion/prefiltered/" + scene.name(), [&scene](benchmark::State& state) {
    measure_occlusion(state, scene, Estimator::prefiltered);
  });
  add("ClosestHit/" + scene.name(),
      [&scene](benchmark::State& state) { measure_closest_hit(state, scene); });
}

}  // namespace dapple::bench
