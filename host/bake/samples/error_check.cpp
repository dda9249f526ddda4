#include "bake/samples/error_check.hpp"

#include <algorithm>
#include <array>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// The most places that are compared, and their share of all: their ratio is known to 0.04, and to
/// 0.2 where there are fewest.
constexpr std::size_t kMostPlaces = 1024, kFewestPlaces = 48, kShare = 16;

/// The assumption that samples are independent counts as much as so many places.
constexpr double kPlacesOfPrior = 8;

std::vector<std::uint32_t> chosen_places(const ValueSums& sums) {
  std::vector<std::uint32_t> chosen;
  const std::size_t count = std::min(kMostPlaces, sums.size() / kShare);
  for (std::uint32_t i = 0; chosen.size() < count && count >= kFewestPlaces; ++i) {
    const auto place = static_cast<std::uint32_t>(spread_choice(i, sums.size()));
    const std::span<const std::uint32_t> card = sums.card_of(place);
    chosen.push_back(place);
    if (!card.empty()) chosen.insert(chosen.end(), card.begin(), card.end());
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

ErrorCheck::ErrorCheck(const SampledSurface& surface, const ValueSums& sums, BakeSides sides)
    : places_(chosen_places(sums)),
      second_({std::vector<std::uint32_t>(places_.size() + 1, SmallParts::kLarge), 0}, sides) {
  if (places_.empty()) return;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (!surface.can_be_sampled(i)) continue;
    const std::array<std::uint32_t, 3> around = surface.places(i);
    if (std::any_of(around.begin(), around.end(),
                    [&](std::uint32_t place) { return index_of(place) < places_.size(); }))
      elements_.push_back(i);
  }
}

std::uint32_t ErrorCheck::index_of(std::uint32_t place) const {
  const auto at = std::lower_bound(places_.begin(), places_.end(), place);
  const bool is_compared = at != places_.end() && *at == place;
  return static_cast<std::uint32_t>((is_compared ? at : places_.end()) - places_.begin());
}

void ErrorCheck::add(std::vector<SurfaceSample> samples, const TracedSamples& found) {
  for (SurfaceSample& sample : samples)
    for (std::uint32_t& place : sample.place) place = index_of(place);
  second_.add(samples, found);
}

// Of one place, or of all places of a card.
void ErrorCheck::compare(const ValueSums& sums, std::span<const std::uint32_t> places,
                         Differences& differences) const {
  std::vector<std::array<double, 2>> values;
  std::array<double, 2> mean{};
  for (const std::uint32_t place : places) {
    const std::uint32_t at = index_of(place);
    if (!sums.is_sampled(place) || !second_.is_sampled(at)) continue;
    values.push_back({double{sums.scalar(place)}, double{sums.scalar(place, second_, at)}});
    for (const std::size_t set : {0, 1}) mean[set] += values.back()[set];
    differences.told += double{sums.squared_noise(place)};
  }
  const auto count = static_cast<double>(values.size());
  differences.places += values.size();
  if (values.empty()) return;
  for (double& of_set : mean) of_set /= count;
  differences.squares += 0.5 * count * (mean[0] - mean[1]) * (mean[0] - mean[1]);
  if (values.size() < 2) return;
  differences.of_cards += values.size();
  for (const std::array<double, 2>& value : values) {
    const double one = value[0] - mean[0], other = value[1] - mean[1];
    differences.own += 0.5 * (one * one + other * other);
    differences.cross += one * other;
  }
}

// Of differences d within cards in both sets, c d predicts d' best for c = E[d d'] / E[d^2]. What
// it is wrong by, beyond the noise of d', is c^2 E[d^2] + (1 - 2 c) E[d d'].
ErrorFit ErrorCheck::fit(const ValueSums& sums) const {
  Differences all;
  for (const std::uint32_t& place : places_) {
    const std::span<const std::uint32_t> card = sums.card_of(place);
    if (card.empty())
      compare(sums, {&place, 1}, all);
    else if (card.front() == place)
      compare(sums, card, all);
  }
  ErrorFit fit;
  if (all.places < kFewestPlaces / 2 || !(all.told > 0)) return fit;
  if (all.of_cards >= kFewestPlaces / 2 && all.own > 0) {
    const double prior = kPlacesOfPrior * all.own / static_cast<double>(all.of_cards);
    fit.contrast =
        static_cast<float>(std::clamp((all.cross + prior) / (all.own + prior), 0.0, 1.0));
  }
  const double c = double{fit.contrast};
  const double squares = all.squares + c * c * all.own + (1 - 2 * c) * all.cross;
  const double prior = kPlacesOfPrior * all.told / static_cast<double>(all.places);
  fit.ratio = static_cast<float>((squares + prior) / (all.told + prior));
  return fit;
}

}  // namespace dapple
