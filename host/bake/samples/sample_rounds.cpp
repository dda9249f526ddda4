#include "bake/samples/sample_rounds.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bake/placement_choice.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// Rays that are traced between two questions whether to stop: a fraction of a second.
constexpr std::size_t kRaysAtOnce = 1u << 21;

/// A sample of fewer rays counts as of so many: it takes time of its own.
constexpr int kFewestRays = 8;

/// A round multiplies the samples of an element by this at most: early variances are uncertain.
constexpr float kMaxGrowth = 4;

/// A round that would take fewer samples of an element in the mean does not pay: it visits all.
constexpr double kMinRound = 0.005;

/// A round takes as long as one of so many samples, at least (experiment 561): surfaces of a few
/// elements begin with more samples of each, and take more of them in a round.
constexpr double kLeastRound = 512;
constexpr std::uint32_t kFirstOfFew = 8;

/// Samples of a place before its first error is known, where each is in one of several placements:
/// a few are often in like ones by chance, and then tell nothing of the others.
constexpr double kSamplesInPlacements = 16;

/// Places of an element, three or one.
double place_count(const std::array<std::uint32_t, 3>& places) {
  return places[0] == places[1] && places[1] == places[2] ? 1 : 3;
}

}  // namespace

SampleRounds::SampleRounds(const SampledSurface& surface, std::uint32_t hash,
                           const Placements& placements, BakeTracing& tracing, ValueSums& sums,
                           BakeSides sides, const ValueSums* ao)
    : surface_(surface),
      hash_(hash),
      placements_(placements),
      tracing_(tracing),
      trace_(ao ? tracing.light : tracing.ao),
      sums_(sums),
      ao_(ao),
      lights_(ao ? std::max<std::size_t>(1, tracing.lights) : 1),
      variance_(surface.size(), this->placements()),
      check_(surface, sums, sides),
      checked_(check_.elements().size()),
      taken_(surface.size()) {}

bool SampleRounds::run(const RoundOptions& options) {
  if (!tracing_.progress.add(0)) return false;
  target_error_ = options.target_error;
  const bool is_fixed = target_error_ <= 0;
  is_in_all_placements_ = is_fixed && static_cast<std::size_t>(options.fixed.samples) >=
                                          kPointsOfPlacement * placements();
  sums_.set_sampling({is_fixed ? options.fixed.rays : options.rays, placements() > 1});
  const bool done =
      is_fixed ? take(static_cast<std::uint32_t>(options.fixed.samples), options.fixed.rays)
               : take(std::min(first_samples(options.first), options.limit), options.rays) &&
                     refine(options.limit);
  if (done && is_fixed) judge();
  tracing_.progress.show();
  return done;
}

// In several placements, all of them if they are few.
std::uint32_t SampleRounds::first_samples(std::uint32_t least) const {
  const auto of_round = static_cast<std::uint32_t>(
      kLeastRound / static_cast<double>(std::max<std::size_t>(1, taken_.size())));
  least = std::max(least, std::min(kFirstOfFew, of_round));
  if (placements() < 2) return least;
  double uses = 0;  // of places by elements
  for (std::size_t i = 0; i < surface_.size(); ++i) uses += place_count(surface_.places(i));
  const double of_place = std::max(1.0, uses / static_cast<double>(sums_.size()));
  const auto enough = static_cast<std::uint32_t>(std::ceil(kSamplesInPlacements / of_place));
  return std::max(least, std::min(placements(), enough));
}

// `samples` of each element, both sides. False: stopped.
bool SampleRounds::take(std::uint32_t samples, int rays) {
  rays_ = rays;
  const auto counted = static_cast<std::size_t>(std::max(rays, kFewestRays));
  samples_at_once_ = std::max<std::size_t>(1, kRaysAtOnce / (counted * lights_));
  std::vector<std::uint32_t> wanted(taken_.size(), samples);
  return round(wanted);
}

// Rounds until the standard error of nearly all values is the target, or elements have
// `max_samples` samples.
bool SampleRounds::refine(std::uint32_t max_samples) {
  std::vector<std::uint32_t> wanted(taken_.size());
  for (;;) {
    judge();
    const std::vector<float> factors = sums_.missing_samples(target_error_);
    double more = 0;
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      float factor = 1;
      for (const std::uint32_t place : surface_.places(i))
        factor = std::max(factor, factors[place]);
      const float needed = std::ceil(static_cast<float>(taken_[i]) * std::min(factor, kMaxGrowth));
      wanted[i] = std::clamp(static_cast<std::uint32_t>(needed), taken_[i], max_samples);
      more += wanted[i] - taken_[i];
    }
    if (more <= kMinRound * static_cast<double>(taken_.size())) break;
    if (more < kLeastRound) more = double_missing(wanted, max_samples);
    tracing_.progress.expect(more);
    if (!round(wanted)) return false;
  }
  count_values(max_samples);
  return true;
}

// Returns how many samples are missing then.
double SampleRounds::double_missing(std::vector<std::uint32_t>& wanted,
                                    std::uint32_t max_samples) const {
  double more = 0;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (wanted[i] > taken_[i])
      wanted[i] = std::max(wanted[i], std::min(2 * taken_[i], max_samples));
    more += wanted[i] - taken_[i];
  }
  return more;
}

// Counts the values that have samples outside of closed geometry, and those with an error above the
// target around which no sample may be added.
void SampleRounds::count_values(std::uint32_t max_samples) {
  std::vector<bool> can_grow(sums_.size());
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    if (!surface_.can_be_sampled(i)) continue;
    for (const std::uint32_t place : surface_.places(i))
      if (taken_[i] < max_samples) can_grow[place] = true;
  }
  const std::vector<float> squares = sums_.squared_errors();
  BakeStatistics& statistics = tracing_.statistics;
  TargetStatistics& counts = ao_ ? statistics.light_target : statistics.ao_target;
  for (std::uint32_t place = 0; place < squares.size(); ++place) {
    if (!sums_.is_sampled(place)) continue;
    ++counts.values;
    if (!can_grow[place] && squares[place] > target_error_ * target_error_) ++counts.above;
  }
}

// Takes samples until each element has `wanted` of them.
bool SampleRounds::round(const std::vector<std::uint32_t>& wanted) {
  for (std::uint32_t i = 0; i < taken_.size(); ++i) {
    if (!surface_.can_be_sampled(i)) taken_[i] = wanted[i];
    for (; taken_[i] < wanted[i]; ++taken_[i]) next_.push_back({i, taken_[i]});
    if (next_.size() >= samples_at_once_ && !trace()) return false;
  }
  if (!trace() || !trace()) return false;
  trace_second_set();
  return true;
}

// As many samples of the elements to be compared as were taken of each.
void SampleRounds::trace_second_set() {
  std::vector<SampleIndex> indices;
  for (std::size_t k = 0; k < checked_.size(); ++k) {
    const std::uint32_t element = check_.elements()[k];
    for (; checked_[k] < taken_[element]; ++checked_[k])
      indices.push_back({element, checked_[k], 1});
  }
  if (indices.empty()) return;
  const Batch batch = make_batch(std::move(indices));
  const TracedSamples found = traced(batch, trace_.of_check);
  check_.add(batch.samples, found);
  count(found);
}

// Tells errors by all samples so far.
void SampleRounds::judge() {
  sums_.choose_sides(target_error_);
  set_variance_factors();
  const ErrorFit fit = check_.fit(sums_);
  sums_.set_noise_ratio(fit.ratio);
  sums_.set_contrast(fit.contrast);
}

// A sample, without the sides that count for no value.
SurfaceSample SampleRounds::sample(const SampleIndex& index) const {
  SurfaceSample sample = surface_.sample(
      index.element, is_in_all_placements_ ? index.number / placements() : index.number,
      index.sequence);
  bool front = false, back = false;
  for (const std::uint32_t place : surface_.places(index.element)) {
    front = front || sums_.is_wanted(place, false);
    back = back || sums_.is_wanted(place, true);
  }
  sample.front = front;
  sample.back = sample.back && back;
  // Of lights: where the sun does not shine, most samples are dark.
  sample.may_be_inside =
      !ao_ || std::any_of(sample.place.begin(), sample.place.end(),
                          [&](std::uint32_t place) { return ao_->has_inside(place); });
  return sample;
}

SampleRounds::Batch SampleRounds::make_batch(std::vector<SampleIndex> indices) {
  Batch batch;
  batch.indices = std::move(indices);
  batch.samples.resize(batch.indices.size());
  batch.placement.resize(batch.indices.size());
  batch.hash = hash_of(hash_, batch_);
  tbb::parallel_for(std::size_t{0}, batch.indices.size(), [&](std::size_t i) {
    const SampleIndex& index = batch.indices[i];
    batch.samples[i] = sample(index);
    batch.placement[i] = placement_of_sample(index.number, placements(),
                                             hash_of(~hash_ - index.sequence, index.element));
  });
  if (!batch.indices.empty()) ++batch_;
  return batch;
}

// Starts tracing the samples of the list, and adds what the batch before found meanwhile. Asks
// whether to stop in between, when no batch is traced: a driver may hang in the next.
bool SampleRounds::trace() {
  Batch batch = make_batch(std::exchange(next_, {}));
  std::optional<TracedSamples> found;
  if (traced_.valid()) found = traced_.get();
  Batch before = std::move(batch_traced_);
  const bool goes_on = !found || tracing_.progress.add(before.samples.size());
  batch_traced_ = std::move(batch);
  if (goes_on && !batch_traced_.samples.empty())
    traced_ =
        std::async(std::launch::async, [this] { return traced(batch_traced_, trace_.values); });
  if (!found) return true;
  add_traced(before, *found);
  return goes_on;
}

TracedSamples SampleRounds::traced(const Batch& batch, const TraceSamples& trace) const {
  return trace(batch.samples, batch.placement, placements_, rays_, batch.hash);
}

void SampleRounds::count(const TracedSamples& found) {
  tracing_.statistics.points += found.points;
  tracing_.statistics.rays += found.rays;
  for (const std::uint8_t inside : found.inside) tracing_.statistics.inside_samples += inside;
}

void SampleRounds::add_traced(const Batch& batch, const TracedSamples& found) {
  sums_.add(batch.samples, found);
  count(found);
  for (std::size_t i = 0; i < batch.samples.size() && placements() > 1; ++i)
    if (!found.is_inside(i))
      variance_.add(batch.indices[i].element, batch.placement[i], batch.samples[i],
                    found.front[i].scalar, found.back[i].scalar);
}

// Of the elements around a place, that whose samples are the least balanced counts.
void SampleRounds::set_variance_factors() {
  if (placements() < 2) return;
  const float share = variance_.share_within();
  std::vector<float> factors(sums_.size());
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    if (!surface_.can_be_sampled(i)) continue;
    const std::array<std::uint32_t, 3> places = surface_.places(i);
    const bool is_balanced = is_in_all_placements_ || place_count(places) == 1;
    const float factor =
        variance_factor(taken_[i], placements(), share, is_balanced ? 1 : kBalanceOfCorners);
    for (const std::uint32_t place : places) factors[place] = std::max(factors[place], factor);
  }
  sums_.set_variance_factors(std::move(factors));
}

}  // namespace dapple
