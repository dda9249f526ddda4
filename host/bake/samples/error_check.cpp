#include "bake/samples/error_check.hpp"

#include <algorithm>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// The most places that are compared, and their share of all: their ratio is known to 0.06, and to
/// 0.2 where there are fewest.
constexpr std::size_t kMostPlaces = 512, kFewestPlaces = 48, kShare = 16;

/// The assumption that samples are independent counts as much as so many places.
constexpr double kPlacesOfPrior = 8;

std::vector<std::uint32_t> chosen_places(std::size_t places) {
  std::vector<std::uint32_t> chosen;
  const std::size_t count = std::min(kMostPlaces, places / kShare);
  for (std::uint32_t i = 0; i < count && count >= kFewestPlaces; ++i)
    chosen.push_back(static_cast<std::uint32_t>(spread_choice(i, places)));
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

ErrorCheck::ErrorCheck(const SampledSurface& surface, std::size_t places, BakeSides sides)
    : places_(chosen_places(places)),
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

float ErrorCheck::ratio(const ValueSums& sums) const {
  double told = 0, squares = 0;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const std::uint32_t place = places_[i];
    if (!sums.is_sampled(place) || !second_.is_sampled(i)) continue;
    const double difference = double{sums.scalar(place)} - double{sums.scalar(place, second_, i)};
    squares += 0.5 * difference * difference;
    told += double{sums.squared_error(place)};
    ++count;
  }
  if (count < kFewestPlaces / 2 || !(told > 0)) return 1;
  const double prior = kPlacesOfPrior * told / static_cast<double>(count);
  return static_cast<float>((squares + prior) / (told + prior));
}

}  // namespace dapple
