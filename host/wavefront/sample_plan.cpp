#include "wavefront/sample_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace dapple {
namespace {

std::uint32_t whole_batches(int samples) {
  return (static_cast<std::uint32_t>(samples) + DAPPLE_BATCH - 1) / DAPPLE_BATCH * DAPPLE_BATCH;
}

}  // namespace

SamplePlan::SamplePlan(std::uint32_t pixels, const RenderOptions& options)
    : samples_(pixels, 0),
      least_(static_cast<std::uint32_t>(options.spp)),
      most_(least_),
      target_(options.target_error) {
  if (!is_adaptive()) return;
  // Two batches are the least that tell a variance.
  least_ = std::max(2 * DAPPLE_BATCH, whole_batches(options.spp));
  most_ = std::max(least_, whole_batches(options.max_spp));
}

WorkGroup SamplePlan::first() {
  WorkGroup group;
  group.samples = least_;
  for (std::uint32_t pixel = 0; pixel < samples_.size(); ++pixel) {
    group.work.push_back({pixel, 0});
    samples_[pixel] = least_;
  }
  return group;
}

std::vector<WorkGroup> SamplePlan::next(const std::vector<std::vector<float>>& variances) {
  std::map<std::uint32_t, WorkGroup> groups;
  double done = 0, wanted = 0;
  for (std::uint32_t pixel = 0; pixel < samples_.size(); ++pixel) {
    const std::uint32_t batches = samples_[pixel] / DAPPLE_BATCH;
    float variance = 0;
    for (const std::vector<float>& pass : variances) variance = std::max(variance, pass[pixel]);
    const double enough = std::ceil(double{variance} / (double{target_} * target_));
    const double most = most_ / DAPPLE_BATCH;
    done += batches;
    if (batches >= std::min(enough, most)) continue;
    wanted += std::min(enough, most) - batches;
    const auto more = static_cast<std::uint32_t>(
        std::min({enough - batches, most - batches, static_cast<double>(batches)}));
    // Powers of two make few groups; what is missing after one comes with the next round.
    const std::uint32_t samples = std::bit_floor(more) * DAPPLE_BATCH;
    WorkGroup& group = groups[samples];
    group.samples = samples;
    group.work.push_back({pixel, samples_[pixel]});
    samples_[pixel] += samples;
  }
  fraction_done_ = std::max(fraction_done_, done / (done + wanted));
  std::vector<WorkGroup> out;
  for (auto& [samples, group] : groups) out.push_back(std::move(group));
  return out;
}

}  // namespace dapple
