#include "render/bias_tracer.hpp"

#include <algorithm>
#include <bit>

#include "camera/camera_splitting.hpp"
#include "passes/occlusion_pass.hpp"

namespace dapple {
namespace {

/// Rays of a layer that are traced at once: enough for all threads of a large machine.
constexpr std::size_t kRaysAtOnce = 1u << 15;

/// Exact rays may cost so many times what the same rays cost prefiltered; where they cost more,
/// fewer are traced. Counted in nodes and primitives, because a clock would make results differ
/// from run to run.
constexpr double kMaxCost = 2.5;

double cost_of(const Occlusion& found) {
  return static_cast<double>(found.visits & 65535u) + static_cast<double>(found.visits >> 16);
}

/// Index of the sample among the slice's hits; below 0: it missed.
std::int64_t slot_of(std::span<const SampleHits> hits, std::uint32_t sample) {
  const SampleHits& record = hits[sample / DAPPLE_HIT_BITS];
  const uint bit = 1u << sample % DAPPLE_HIT_BITS;
  if (!(record.hits & bit)) return -1;
  return std::int64_t{record.first_slot} + std::popcount(record.hits & (bit - 1u));
}

}  // namespace

BiasTracer::BiasTracer(DeviceContext& context, const DeviceBuffers& scene,
                       const RenderOptions& options, const View& view, std::size_t layers,
                       BiasSums sums)
    : context_(context),
      scene_(scene),
      options_(options),
      crop_(view.crop),
      splitting_bits_(std::countr_zero(static_cast<unsigned>(splitting_factor(options)))),
      sums_(std::move(sums)),
      share_(double{options.report_bias}),
      waiting_(layers) {
  sums_.differences.resize(layers);
  for (std::vector<float>& layer : sums_.differences) layer.resize(view.pixel_count());
}

void BiasTracer::choose(const SliceParams& slice, std::span<const PixelWork> work) {
  const ExactSamples samples(share_);
  const auto width = static_cast<std::uint32_t>(crop_.width());
  chosen_.clear();
  for (std::uint32_t entry = 0; entry < slice.pixel_count; ++entry) {
    const PixelWork& of_pixel = work[slice.first_work + entry];
    const std::uint32_t x = of_pixel.pixel % width + static_cast<std::uint32_t>(crop_.x0);
    const std::uint32_t y = of_pixel.pixel / width + static_cast<std::uint32_t>(crop_.y0);
    const std::uint32_t first = of_pixel.first_sample + slice.first_sample;
    for (std::uint32_t i = 0; i < slice.sample_count; ++i)
      if (samples.has(x, y, (first + i) >> splitting_bits_))
        chosen_.push_back({entry * slice.sample_count + i, of_pixel.pixel});
  }
}

void BiasTracer::collect(std::size_t layer, const Queues& queues, const OcclusionParams& params) {
  sums_.rays += params.ray_count;
  if (chosen_.empty()) return;
  Waiting& waiting = waiting_[layer];
  waiting.params = params;
  {
    const HostView hit_view = context_.view(queues.sample_hits);
    const HostView ray_view = context_.view(queues.rays);
    const HostView found_view = context_.view(queues.occlusions);
    const std::span<const SampleHits> hits = hit_view.values<SampleHits>();
    for (const Chosen& chosen : chosen_) {
      const std::int64_t slot = slot_of(hits, chosen.sample);
      if (slot < 0) continue;
      const std::size_t begin = static_cast<std::size_t>(slot) * params.rays_per_point;
      const auto rays = ray_view.values<Ray>().subspan(begin, params.rays_per_point);
      const auto found = found_view.values<Occlusion>().subspan(begin, params.rays_per_point);
      waiting.rays.insert(waiting.rays.end(), rays.begin(), rays.end());
      waiting.prefiltered.insert(waiting.prefiltered.end(), found.begin(), found.end());
      waiting.pixels.push_back(chosen.pixel);
      waiting.factors.push_back(static_cast<float>(1 / share_));
    }
  }
  if (waiting.rays.size() >= kRaysAtOnce) trace(layer);
}

void BiasTracer::finish() {
  for (std::size_t layer = 0; layer < waiting_.size(); ++layer)
    if (!waiting_[layer].rays.empty()) trace(layer);
}

void BiasTracer::trace(std::size_t layer) {
  Waiting& waiting = waiting_[layer];
  const std::size_t count = waiting.rays.size();
  if (queues_.rays.bytes() < count * sizeof(Ray)) {
    queues_.rays = context_.allocate(count * sizeof(Ray));
    queues_.occlusions = context_.allocate(count * sizeof(Occlusion));
  }
  context_.write(queues_.rays, waiting.rays.data(), count * sizeof(Ray));
  OcclusionParams params = waiting.params;
  params.ray_count = static_cast<uint>(count);
  occlusion_pass(context_, queues_, scene_, "bias report", Estimator::exact, params,
                 RayOrder::by_pixel);
  std::vector<Occlusion> exact(count);
  context_.read(queues_.occlusions, exact.data(), count * sizeof(Occlusion));
  add(layer, exact);
  waiting = {};
  if (sums_.exact_cost > kMaxCost * sums_.prefiltered_cost)
    share_ = double{options_.report_bias} * kMaxCost * sums_.prefiltered_cost / sums_.exact_cost;
}

void BiasTracer::add(std::size_t layer, std::span<const Occlusion> exact) {
  const Waiting& waiting = waiting_[layer];
  const std::size_t rays = waiting.params.rays_per_point;
  std::vector<float>& differences = sums_.differences[layer];
  for (std::size_t sample = 0; sample < waiting.pixels.size(); ++sample) {
    float difference = 0;
    for (std::size_t r = sample * rays; r < (sample + 1) * rays; ++r) {
      difference +=
          waiting.rays[r].weight * (waiting.prefiltered[r].transmittance - exact[r].transmittance);
      sums_.exact_cost += cost_of(exact[r]);
      sums_.prefiltered_cost += cost_of(waiting.prefiltered[r]);
    }
    differences[waiting.pixels[sample]] +=
        difference * waiting.factors[sample] / static_cast<float>(rays);
  }
  sums_.exact_rays += static_cast<double>(exact.size());
}

}  // namespace dapple
