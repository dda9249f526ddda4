// Measures the traversal kernels with the device's own clock. In: AO rays in device memory, and a
// camera. Out: seconds of a launch, node visits and triangle tests for each ray.
#include <benchmark/benchmark.h>

#include "benchmarks.hpp"
#include "device/context.hpp"
#include "passes/camera_pass.hpp"
#include "passes/light_pass.hpp"
#include "passes/occlusion_pass.hpp"

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

void report_work(benchmark::State& state, double visits, double tests, double rays) {
  state.counters["visits/ray"] = visits / rays;
  state.counters["tests/ray"] = tests / rays;
  state.counters["rays"] = benchmark::Counter(rays * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
}

/// Measures `launch`. The first launch, which compiles the kernel and fills caches, is not counted.
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

/// Measures the scene's AO rays. Each `rays_per_point` consecutive rays count as rays of one point.
void measure_occlusion(benchmark::State& state, BenchScene& scene, Estimator estimator,
                       uint rays_per_point, RayOrder order) {
  const SceneRays& rays = scene.rays();
  const DeviceBuffers& buffers = *scene.on_device().buffers;
  DeviceContext& context = scene.device().context();
  OcclusionParams params{};
  params.scene = buffers.params;
  params.ray_count = static_cast<uint>(rays.ao_count);
  params.rays_per_point = rays_per_point;
  params.footprint = kDefaultFootprint;
  time_launches(state, context, [&] {
    occlusion_pass(context, rays.ao, buffers, kLabel, estimator, params, order);
  });
  std::vector<Occlusion> found(rays.ao_count);
  context.read(rays.ao.occlusions, found.data(), found.size() * sizeof(Occlusion));
  double visits = 0, tests = 0;
  for (const Occlusion& one : found) {
    visits += one.visits & 0xffffu;
    tests += one.visits >> 16;
  }
  report_work(state, visits, tests, static_cast<double>(rays.ao_count));
}

/// Measures the picture's camera pass with `samples` a pixel. The number of samples in a slice is
/// the number of pixels of the picture.
void measure_camera(benchmark::State& state, BenchScene& scene, uint samples) {
  const SceneRays& rays = scene.rays();
  const DeviceBuffers& buffers = *scene.on_device().buffers;
  DeviceContext& context = scene.device().context();
  CameraParams camera = scene.camera();
  const uint pixels = static_cast<uint>(rays.camera_count) / samples;
  const auto for_each_slice = [&](const auto& work) {
    for (uint slice = 0; slice < samples; ++slice) {
      camera.slice = {slice * pixels, pixels, 0, samples};
      camera_pass(context, buffers, rays.camera, camera);
      work();
    }
  };
  time_launches(state, context, [&] { for_each_slice([] {}); });
  std::vector<SampleHits> sample_hits(rays.camera_count / DAPPLE_HIT_BITS);
  double visits = 0, tests = 0;
  // A record has the totals of the work-item that traced its rays, as in film/film.cl.
  constexpr double kOfRecord = double{DAPPLE_HIT_BITS} / double{DAPPLE_ITEM_RAYS};
  for_each_slice([&] {
    context.read(rays.camera.sample_hits, sample_hits.data(),
                 sample_hits.size() * sizeof(SampleHits));
    for (const SampleHits& record : sample_hits) {
      visits += kOfRecord * record.visits;
      tests += kOfRecord * record.tests;
    }
  });
  report_work(state, visits, tests, static_cast<double>(rays.camera_count * samples));
}

/// Measures the generation of one ray to the scene's dome from every point that the camera sees.
void measure_dome_rays(benchmark::State& state, BenchScene& scene) {
  const SceneRays& rays = scene.rays();
  const DeviceBuffers& buffers = *scene.on_device().buffers;
  DeviceContext& context = scene.device().context();
  LightParams params{};
  params.point_count = static_cast<uint>(rays.ao_count / kRaysPerPoint);
  params.rays = 1;
  params.inverse_count = 1;
  time_launches(state, context, [&] { light_ray_pass(context, buffers, rays.camera, params); });
  state.counters["rays"] = benchmark::Counter(
      static_cast<double>(params.point_count) * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
}

}  // namespace

void register_tracing(BenchScene& scene) {
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const auto add_occlusion = [&](const std::string& kind, uint rays_per_point, RayOrder order) {
      register_measured(kind + "/" + name_of(estimator) + "/" + scene.name(), kRepetitions,
                        [&scene, estimator, rays_per_point, order](benchmark::State& state) {
                          measure_occlusion(state, scene, estimator, rays_per_point, order);
                        });
    };
    add_occlusion("Occlusion", 1, RayOrder::any);
    add_occlusion("OcclusionPixelPackets", 1, RayOrder::by_pixel);
    // So few exact rays of a point are traced in pixel packets.
    if (estimator == Estimator::prefiltered)
      add_occlusion("OcclusionPointPackets", kRaysPerPoint, RayOrder::any);
  }
  // Before the camera passes, because these overwrite the points.
  register_measured("DomeRays/" + scene.name(), kRepetitions,
                    [&scene](benchmark::State& state) { measure_dome_rays(state, scene); });
  for (const uint samples : {1u, 16u}) {
    register_measured(
        "Camera/" + std::to_string(samples) + "/" + scene.name(), kRepetitions,
        [&scene, samples](benchmark::State& state) { measure_camera(state, scene, samples); });
  }
}

}  // namespace dapple::bench
