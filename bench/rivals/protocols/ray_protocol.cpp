#include "rivals/protocols/ray_protocol.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <thread>

#include "accuracy/pixel_statistics.hpp"
#include "device/context.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "rivals/embree/stratified.hpp"

namespace dapple::bench {
namespace {

constexpr auto kPause = std::chrono::milliseconds(2);
constexpr int kCalibrationRounds = 5;

struct Traced {
  double seconds = 0, transmittance = 0, visits = 0, tests = 0;  ///< the last three are means
};

Traced trace_by_embree(const EmbreeScenes& scenes, const EmbreeMethod& method,
                       const PreparedRays& rays) {
  struct Worker {
    explicit Worker(const EmbreeScenes& s) : tracer(s, kContestBlack) {}
    EmbreeTracer tracer;
    TransmittanceBatch found;
    double sum = 0;
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Worker>> workers(
      [&] { return std::make_unique<Worker>(scenes); });
  const auto start = std::chrono::steady_clock::now();
  tbb::parallel_for(std::size_t{0}, rays.batches.size(), [&](std::size_t b) {
    const FlushDenormals flush;
    Worker& worker = *workers.local();
    worker.tracer.occlusion(method, *rays.batches[b], worker.found);
    for (unsigned i = 0; i < rays.batches[b]->count; ++i)
      worker.sum += worker.found.transmittance[i];
  });
  Traced traced;
  traced.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const auto& worker : workers) traced.transmittance += worker->sum;
  traced.transmittance /= static_cast<double>(rays.rays.size());
  return traced;
}

/// The rays in the memory of dapple's device.
class DeviceRays {
 public:
  DeviceRays(RivalScene& scene, const PreparedRays& rays)
      : context_(scene.device.context()),
        scene_(*scene.on_device.buffers),
        results_(rays.rays.size()) {
    queues_.rays = context_.allocate(rays.rays.size() * sizeof(Ray));
    queues_.occlusions = context_.allocate(results_.size() * sizeof(Occlusion));
    if (traces_scalar(context_))
      queues_.order = context_.allocate(results_.size() * sizeof(std::uint32_t));
    context_.write(queues_.rays, rays.rays.data(), rays.rays.size() * sizeof(Ray));
  }

  Traced trace(Estimator estimator, std::size_t together, float roulette) {
    OcclusionParams params{};
    params.scene = scene_.params;
    params.ray_count = static_cast<uint>(results_.size());
    params.rays_per_point = static_cast<uint>(together);
    params.footprint = kDefaultFootprint;
    params.roulette = roulette;
    const double before = device_seconds();
    occlusion_pass(context_, queues_, scene_, "rivals", estimator, params);
    Traced traced;
    traced.seconds = device_seconds() - before;
    context_.read(queues_.occlusions, results_.data(), results_.size() * sizeof(Occlusion));
    for (const Occlusion& found : results_) {
      traced.transmittance += found.transmittance;
      traced.visits += found.visits & 0xffffu;
      traced.tests += found.visits >> 16;
    }
    const auto count = static_cast<double>(results_.size());
    traced.transmittance /= count;
    traced.visits /= count;
    traced.tests /= count;
    return traced;
  }

 private:
  double device_seconds() {
    context_.finish();
    double seconds = 0;
    for (const auto& [label, pass_seconds] : context_.pass_seconds()) seconds += pass_seconds;
    return seconds;
  }

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  Queues queues_;
  std::vector<Occlusion> results_;
};

struct Racer {
  Racer(std::string name, bool is_embree, std::function<Traced()> trace) : run(std::move(trace)) {
    row.name = std::move(name);
    row.is_embree = is_embree;
  }
  std::function<Traced()> run;
  RayRow row;
  std::vector<double> seconds;
};

void finish(Racer& racer, double rays) {
  const double middle = median(racer.seconds);
  const auto [least, most] = std::minmax_element(racer.seconds.begin(), racer.seconds.end());
  racer.row.rays_a_second = rays / middle;
  racer.row.fastest_seconds = *least;
  racer.row.spread = (*most - *least) / middle;
}

}  // namespace

PreparedRays prepare_rays(std::span<const Surface> points, std::uint32_t seed) {
  PreparedRays prepared;
  const std::size_t count = points.size() * kRaysAPoint;
  for (std::size_t first = 0; first < count; first += kBatchCapacity) {
    RayBatch& batch = *prepared.batches.emplace_back(std::make_unique<RayBatch>());
    fill_ao_rays(points, kRaysAPoint, first, seed, batch);
    for (unsigned i = 0; i < batch.count; ++i) {
      const V3f& normal = points[(first + i) / kRaysAPoint].normal;
      Ray ray{};
      float cosine = 0;
      for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = batch.origin[axis][i];
        ray.direction[axis] = batch.direction[axis][i];
        cosine += normal[axis] * ray.direction[axis];
      }
      ray.t_max = batch.t_max[i];
      // 1 / (n pdf), as in kernels/occlusion/ao_rays.clh.
      constexpr float kPi = std::numbers::pi_v<float>;
      ray.solid_angle = std::min(2 * kPi, kPi / (kRaysAPoint * std::max(1e-4f, cosine)));
      ray.weight = 1;
      ray.key = batch.key[i];
      prepared.rays.push_back(ray);
    }
  }
  return prepared;
}

std::vector<RayRow> measure_rays(RivalScene& scene, const PreparedRays& rays,
                                 const std::vector<EmbreeMethod>& methods, bool ours, int repeats) {
  std::vector<Racer> racers;
  for (const EmbreeMethod& method : methods) {
    racers.emplace_back("Embree " + method.name(), true, [&scene, &rays, method] {
      return trace_by_embree(scene.embree, method, rays);
    });
  }
  std::optional<DeviceRays> on_device;
  const auto add = [&](const char* name, Estimator estimator, std::size_t together,
                       float roulette = 0) {
    racers.emplace_back(name, false, [&on_device, estimator, together, roulette] {
      return on_device->trace(estimator, together, roulette);
    });
  };
  if (ours) {
    on_device.emplace(scene, rays);
    add("exact", Estimator::exact, 1);
    add("exact packet", Estimator::exact, kRaysAPoint);
    add("exact packet, roulette", Estimator::exact, kRaysAPoint, RenderOptions{}.roulette);
    add("prefiltered", Estimator::prefiltered, 1);
    add("prefiltered packet", Estimator::prefiltered, kRaysAPoint);
  }
  // The first round fills caches and compiles kernels.
  for (int round = 0; round <= repeats; ++round) {
    for (Racer& racer : racers) {
      std::this_thread::sleep_for(kPause);
      const Traced traced = racer.run();
      if (round > 0) racer.seconds.push_back(traced.seconds);
      racer.row.mean_transmittance = traced.transmittance;
      racer.row.visits = traced.visits;
      racer.row.tests = traced.tests;
    }
  }
  std::vector<RayRow> rows;
  for (Racer& racer : racers) {
    finish(racer, static_cast<double>(rays.rays.size()));
    rows.push_back(racer.row);
  }
  return rows;
}

std::vector<EmbreeMethod> best_of_each_alpha(const std::vector<EmbreeMethod>& methods,
                                             const std::vector<double>& seconds) {
  std::vector<EmbreeMethod> best;
  for (const Alpha alpha : {Alpha::stochastic, Alpha::multiplicative}) {
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (methods[i].alpha == alpha && (!first || seconds[i] < seconds[*first])) first = i;
    }
    if (first) best.push_back(methods[*first]);
  }
  return best;
}

std::vector<EmbreeMethod> calibrated_methods(RivalScene& scene, const PreparedRays& rays) {
  const std::vector<EmbreeMethod> methods = occlusion_methods(scene.geometry.flat);
  std::vector<double> seconds;
  for (const RayRow& row : measure_rays(scene, rays, methods, false, kCalibrationRounds))
    seconds.push_back(row.fastest_seconds);
  return best_of_each_alpha(methods, seconds);
}

}  // namespace dapple::bench
