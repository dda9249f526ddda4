#include "render/bias/bias_tracer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "camera/camera_splitting.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/ray_packets.hpp"

namespace dapple {
namespace {

/// Rays of a layer that are traced at once: enough for all threads of a large machine, or for a
/// GPU.
std::size_t rays_at_once(const DeviceInfo& device) {
  return device.kind == "CPU" ? std::size_t{1} << 15 : std::size_t{1} << 18;
}

/// Entries of a slice that a thread looks through at a time.
constexpr std::uint32_t kEntriesOfThread = 2048;

/// Exact rays may cost so many times what the same rays cost prefiltered; where they cost more,
/// fewer are traced. Counted in nodes and primitives, because a clock would make results differ
/// from run to run.
constexpr double kMaxCost = 2.5;

double cost_of(const Occlusion& found) {
  return 1.0 * visits_of(found.visits) + tests_of(found.visits);
}

/// Index of the sample among the slice's hits; below 0: it missed.
std::int64_t slot_of(std::span<const SampleHits> hits, std::uint32_t sample) {
  const SampleHits& record = hits[sample / DAPPLE_HIT_BITS];
  const uint bit = 1u << sample % DAPPLE_HIT_BITS;
  if (!(record.hits & bit)) return -1;
  return std::int64_t{record.first_slot} + std::popcount(record.hits & (bit - 1u));
}

/// How many entries of a list from `first` up to `end`, `most` at most, are neighbours in a row of
/// pixels and continue at the same sample.
std::uint32_t run_length(std::span<const PixelWork> work, std::uint32_t first, std::uint32_t end,
                         std::uint32_t most) {
  const std::uint32_t limit = std::min(most, end - first);
  std::uint32_t length = 1;
  while (length < limit && work[first + length].pixel == work[first].pixel + length &&
         work[first + length].first_sample == work[first].first_sample)
    ++length;
  return length;
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
      rays_at_once_(rays_at_once(context.info())),
      pending_(layers) {
  sums_.differences.resize(layers);
  for (std::vector<float>& layer : sums_.differences) layer.resize(view.pixel_count());
}

void BiasTracer::choose(const SliceParams& slice, std::span<const PixelWork> work) {
  choose_among(slice, {slice.sample_count, 0, splitting_bits_}, work);
}

void BiasTracer::choose_backs(const BackParams& choice, std::span<const PixelWork> work) {
  choose_among(choice.resolve.slice, {choice.slots, choice.group_bits, 0}, work);
}

void BiasTracer::choose_among(const SliceParams& slice, const EntrySamples& of_entry,
                              std::span<const PixelWork> work) {
  const std::span<const PixelWork> of_slice = work.subspan(slice.first_work, slice.pixel_count);
  std::vector<std::vector<ChosenSample>> parts(ceil_div(slice.pixel_count, kEntriesOfThread));
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const auto begin = static_cast<std::uint32_t>(part) * kEntriesOfThread;
    parts[part] = chosen_among(slice, of_entry, of_slice,
                               {begin, std::min(begin + kEntriesOfThread, slice.pixel_count)});
  });
  chosen_factor_ = static_cast<float>(1 / share_);
  chosen_samples_.clear();
  for (const std::vector<ChosenSample>& part : parts)
    chosen_samples_.insert(chosen_samples_.end(), part.begin(), part.end());
}

// Pixels of a row of a unit have the same samples chosen, usually none.
std::vector<BiasTracer::ChosenSample> BiasTracer::chosen_among(const SliceParams& slice,
                                                               const EntrySamples& of_entry,
                                                               std::span<const PixelWork> of_slice,
                                                               const Entries& entries) const {
  const ExactSamples samples(share_);
  const auto width = static_cast<std::uint32_t>(crop_.width());
  std::vector<ChosenSample> chosen;
  std::uint32_t length = 0;
  for (std::uint32_t entry = entries.begin; entry < entries.end; entry += length) {
    const PixelWork& first = of_slice[entry];
    const std::uint32_t column = first.pixel % width;
    const std::uint32_t x = column + static_cast<std::uint32_t>(crop_.x0);
    const std::uint32_t y = first.pixel / width + static_cast<std::uint32_t>(crop_.y0);
    length = run_length(of_slice, entry, entries.end,
                        std::min(kBiasUnit - x % kBiasUnit, width - column));
    const uint first_number = (first.first_sample + slice.first_sample) >> of_entry.group_bits;
    for (uint i = 0; i < of_entry.count; ++i) {
      if (!samples.has(x, y, (first_number + i) >> of_entry.ray_bits)) continue;
      for (std::uint32_t k = 0; k < length; ++k)
        chosen.push_back({(entry + k) * of_entry.count + i, first.pixel + k});
    }
  }
  return chosen;
}

void BiasTracer::keep_hits(const Queues& queues) {
  chosen_slots_.clear();
  chosen_pixels_.clear();
  {
    const HostView hits = context_.view(queues.sample_hits);
    for (const ChosenSample& chosen : chosen_samples_) {
      const std::int64_t slot = slot_of(hits.values<SampleHits>(), chosen.sample);
      if (slot < 0) continue;
      chosen_slots_.push_back(static_cast<std::uint32_t>(slot));
      chosen_pixels_.push_back(chosen.pixel);
    }
  }
  const std::size_t bytes = chosen_slots_.size() * sizeof(std::uint32_t);
  if (slots_.bytes() < bytes) slots_ = context_.allocate(bytes);
  context_.write(slots_, chosen_slots_.data(), bytes);
}

void BiasTracer::collect(std::size_t layer, const Queues& queues, const OcclusionParams& params) {
  sums_.rays += params.ray_count;
  if (chosen_slots_.empty()) return;
  PendingRays& pending = pending_[layer];
  const auto added = static_cast<std::uint32_t>(chosen_slots_.size()) * params.rays_per_point;
  if ((std::size_t{pending.count} + added) * sizeof(Ray) > pending.queues.rays.bytes()) {
    if (pending.count) trace(layer);
    const std::size_t room = rays_at_once_ + std::size_t{added};
    pending.queues.rays = context_.allocate(room * sizeof(Ray));
    pending.queues.occlusions = context_.allocate(room * sizeof(Occlusion));
  }
  pending.params = params;
  gather_pass(context_, queues, slots_, pending.queues, added, params.rays_per_point,
              pending.count);
  pending.count += added;
  pending.pixels.insert(pending.pixels.end(), chosen_pixels_.begin(), chosen_pixels_.end());
  pending.factors.resize(pending.pixels.size(), chosen_factor_);
  if (pending.count >= rays_at_once_) trace(layer);
}

void BiasTracer::finish() {
  for (std::size_t layer = 0; layer < pending_.size(); ++layer)
    if (pending_[layer].count) trace(layer);
}

void BiasTracer::trace(std::size_t layer) {
  PendingRays& pending = pending_[layer];
  const std::size_t bytes = pending.count * sizeof(Occlusion);
  if (exact_.bytes() < bytes) {
    exact_ = context_.allocate(bytes);
    if (traces_scalar(context_)) order_ = context_.allocate(pending.count * sizeof(uint));
  }
  Queues queues;
  queues.rays = pending.queues.rays;
  queues.occlusions = exact_;
  queues.order = order_;
  OcclusionParams params = pending.params;
  params.ray_count = pending.count;
  occlusion_pass(context_, queues, scene_, "bias report", Estimator::exact, params,
                 RayOrder::by_pixel);
  {
    const HostView exact = context_.view(exact_), rays = context_.view(pending.queues.rays),
                   prefiltered = context_.view(pending.queues.occlusions);
    add(layer, rays.values<Ray>(), prefiltered.values<Occlusion>(),
        exact.values<Occlusion>().first(pending.count));
  }
  pending.count = 0;
  pending.pixels.clear();
  pending.factors.clear();
  if (sums_.exact_cost > kMaxCost * sums_.prefiltered_cost)
    share_ = double{options_.report_bias} * kMaxCost * sums_.prefiltered_cost / sums_.exact_cost;
}

void BiasTracer::add(std::size_t layer, std::span<const Ray> rays,
                     std::span<const Occlusion> prefiltered, std::span<const Occlusion> exact) {
  const PendingRays& pending = pending_[layer];
  const std::size_t of_sample = pending.params.rays_per_point;
  std::vector<float>& differences = sums_.differences[layer];
  for (std::size_t sample = 0; sample < pending.pixels.size(); ++sample) {
    float difference = 0;
    for (std::size_t r = sample * of_sample; r < (sample + 1) * of_sample; ++r) {
      difference += rays[r].weight * (prefiltered[r].transmittance - exact[r].transmittance);
      sums_.exact_cost += cost_of(exact[r]);
      sums_.prefiltered_cost += cost_of(prefiltered[r]);
    }
    differences[pending.pixels[sample]] +=
        difference * pending.factors[sample] / static_cast<float>(of_sample);
  }
  sums_.exact_rays += static_cast<double>(exact.size());
}

}  // namespace dapple
