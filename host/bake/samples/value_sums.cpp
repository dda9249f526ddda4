#include "bake/samples/value_sums.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dapple {
namespace {

/// Up to this AO a place sees nothing.
constexpr float kDark = 1e-3f;

/// Samples after which a place is known to see nothing: all of a few rays may be blocked by chance.
constexpr float kSamplesOfDark = 8;

/// The side that seems darker has enough samples when the regret of choosing the other is this
/// share of the target's square (experiment 650).
constexpr float kToleratedRegret = 0.2f;

/// A sample counts for the three corners of its triangle, for each as 2/3 of one of full weight: so
/// the squared error of a part's mean is twice what independent corners would have.
constexpr float kSharedSamples = 2;

/// Places of a card at most.
constexpr std::size_t kMostOfCard = 8;

/// Places that one thread takes at a time.
constexpr std::size_t kPlacesAtOnce = 1u << 14;

/// The sum of the sides' directions; the front's where the sides see alike, so that they cancel but
/// for their noise.
V3f bent_of_both(const V3f& front, const V3f& back) {
  constexpr float kLeast = 0.2f;  // of the lengths
  const V3f sum = front + back;
  return sum.length() > kLeast * (front.length() + back.length()) ? sum : front;
}

}  // namespace

PlacesOfParts::PlacesOfParts(const SmallParts& parts) : begin_(parts.count + 1) {
  for (const std::uint32_t part : parts.of_place)
    if (part != SmallParts::kLarge) ++begin_[part + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  places_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t place = 0; place < parts.of_place.size(); ++place)
    if (parts.of_place[place] != SmallParts::kLarge) places_[next[parts.of_place[place]]++] = place;
}

ValueSums::ValueSums(SmallParts parts, BakeSides sides, std::size_t lights)
    : sides_(sides),
      parts_(std::move(parts)),
      places_of_part_(parts_),
      of_place_(parts_.of_place.size()),
      choice_(of_place_.size()),
      lights_(lights),
      front_light_(of_place_.size() * lights, V3f(0, 0, 0)),
      back_light_(front_light_) {}

void ValueSums::add(std::span<const SurfaceSample> samples, const TracedSamples& found) {
  largest_ = std::max(largest_, found.largest);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (found.is_inside(i))
      add_inside(samples[i]);
    else
      add(samples[i], found, i);
  }
}

void ValueSums::add_inside(const SurfaceSample& sample) {
  for (std::size_t k = 0; k < 3; ++k) {
    BothSides& place = of_place_[sample.place[k]];
    place.inside_weight += sample.weight[k];
    place.inside_squares += sample.weight[k] * sample.weight[k];
  }
}

void ValueSums::add(const SurfaceSample& sample, const TracedSamples& found, std::size_t index) {
  const auto add_to = [&](BothSides& place, float weight, bool turned) {
    if (sample.front) (turned ? place.back : place.front).add(weight, found.front[index]);
    if (sample.back) (turned ? place.front : place.back).add(weight, found.back[index]);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(sample.weight[k] > 0)) continue;
    add_to(of_place_[sample.place[k]], sample.weight[k], sample.turned[k]);
    std::vector<V3f>& light_in_front = sample.turned[k] ? back_light_ : front_light_;
    std::vector<V3f>& light_behind = sample.turned[k] ? front_light_ : back_light_;
    for (std::size_t l = 0; l < lights_; ++l) {
      const std::size_t from = index * lights_ + l, to = sample.place[k] * lights_ + l;
      light_in_front[to] += found.front_light[from] * sample.weight[k];
      light_behind[to] += found.back_light[from] * sample.weight[k];
    }
  }
}

// In parts of fixed size, so that the sums do not depend on the number of threads.
PooledVariance ValueSums::pooled_variance() const {
  const auto add_range = [&](const tbb::blocked_range<std::size_t>& range, PooledVariance sum) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      sum.add(of_place_[i].front);
      sum.add(of_place_[i].back);
    }
    return sum;
  };
  PooledVariance pooled = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, of_place_.size(), kPlacesAtOnce),
      PooledVariance(scale(), sampling_), add_range,
      [](PooledVariance a, const PooledVariance& b) { return a += b; });
  pooled.pool();
  return pooled;
}

// If the errors of both means are normal. The regret is E[min(d, 0)^2] of the difference d, whose
// mean is above 0.
ValueSums::SideChoice ValueSums::BackMinusFront::choice() const {
  if (places == 0) return {0, 0};
  if (!(square_error > 0)) return {difference > 0 ? 1.0f : 0.0f, 0};
  const auto probability_above = [](float z) {
    return 0.5f * std::erfc(z / std::numbers::sqrt2_v<float>);
  };
  const float z = difference / std::sqrt(square_error), distance = std::abs(z);
  const float density =
      std::exp(-0.5f * z * z) * std::numbers::inv_sqrtpi_v<float> / std::numbers::sqrt2_v<float>;
  const float below = (1 + z * z) * probability_above(distance) - distance * density;
  const auto n = static_cast<float>(places);
  return {probability_above(-z), std::max(0.0f, below) * square_error / (n * n)};
}

void ValueSums::BackMinusFront::add(const BothSides& values, const PooledVariance& variance) {
  const SideSums &front = values.front, &back = values.back;
  if (!(front.weight > 0 && back.weight > 0)) return;
  ++places;
  difference += back.mean() - front.mean();
  square_error += variance.of(front) / front.count() + variance.of(back) / back.count();
}

// By small parts: means of single vertices are noisy, and the larger of two is biased. All places
// of a part count the same, however many samples they have.
void ValueSums::choose_sides(float target_error) {
  variance_ = pooled_variance();
  if (sides_ == BakeSides::mean) {
    std::fill(choice_.begin(), choice_.end(), SideChoice{0.5f, 0});
    return;
  }
  tolerated_regret_ = kToleratedRegret * target_error * target_error * scale() * scale();
  tbb::parallel_for(std::size_t{0}, parts_.count, [&](std::size_t part) {
    BackMinusFront of_part;
    for (const std::uint32_t place : places_of_part_[part])
      of_part.add(of_place_[place], variance_);
    of_part.square_error *= kSharedSamples;
    const SideChoice choice = of_part.choice();
    for (const std::uint32_t place : places_of_part_[part]) choice_[place] = choice;
  });
  tbb::parallel_for(std::size_t{0}, choice_.size(), [&](std::size_t i) {
    if (parts_.of_place[i] != SmallParts::kLarge) return;
    BackMinusFront of_place;
    of_place.add(of_place_[i], variance_);
    choice_[i] = of_place.choice();
  });
}

bool ValueSums::is_wanted(std::uint32_t place, bool back) const {
  const SideChoice& choice = choice_[place];
  return sides_ == BakeSides::mean || back == (choice.share_of_back > 0.5f) ||
         choice.regret > tolerated_regret_;
}

float ValueSums::share_of_back(std::uint32_t place, const BothSides& sums) const {
  if (!(sums.front.weight > 0)) return 1;
  return sums.back.weight > 0 ? choice_[place].share_of_back : 0.0f;
}

float ValueSums::scalar(std::uint32_t place, const BothSides& sums) const {
  const float front = sums.front.mean(), back = sums.back.mean();
  return (front + share_of_back(place, sums) * (back - front)) / scale();
}

float ValueSums::squared_noise(std::uint32_t place) const {
  const BothSides& sums = of_place_[place];
  const float share = share_of_back(place, sums);
  float square = 0;
  for (const bool back : {false, true}) {
    const SideSums& side = back ? sums.back : sums.front;
    const float part = back ? share : 1 - share;
    if (side.weight > 0) square += part * part * variance_.of(side) / side.count();
  }
  return square * (factors_.empty() ? 1 : factors_[place]) / (scale() * scale());
}

// What is left of a place's own error in a value that was moved to the mean of its card falls as
// the square of what is left of its difference.
std::vector<float> ValueSums::squared_errors() const {
  std::vector<float> squares(of_place_.size());
  tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t i) {
    const auto place = static_cast<std::uint32_t>(i);
    squares[i] = noise_ratio_ * squared_noise(place) + choice_[i].regret / (scale() * scale());
  });
  const float left = contrast_ * contrast_;
  move_to_means_of_cards([&](std::uint32_t place) -> float& { return squares[place]; }, left);
  return squares;
}

std::vector<float> ValueSums::missing_samples(float target) const {
  std::vector<float> factors = squared_errors();
  tbb::parallel_for(std::size_t{0}, factors.size(), [&](std::size_t i) {
    const BothSides& place = of_place_[i];
    const auto index = static_cast<std::uint32_t>(i);
    const float samples = place.front.count() + place.back.count() + place.inside_count();
    const bool sees_nothing = is_dark(index) || is_inside(index);
    factors[i] = std::max({1.0f, factors[i] / (target * target),
                           sees_nothing && samples > 0 ? kSamplesOfDark / samples : 1.0f});
  });
  return factors;
}

bool ValueSums::is_dark(std::uint32_t place) const {
  const BothSides& sides = of_place_[place];
  return lights_ == 0 && std::max(sides.front.mean(), sides.back.mean()) <= kDark;
}

std::span<const std::uint32_t> ValueSums::card_of(std::uint32_t place) const {
  const std::uint32_t part = parts_.of_place[place];
  if (part == SmallParts::kLarge) return {};
  const std::span<const std::uint32_t> places = places_of_part_[part];
  return places.size() <= kMostOfCard ? places : std::span<const std::uint32_t>{};
}

// Linear shrinkage: the mean squared error of what is left is the smallest. `value`: returns that
// of a place by reference.
template <class Value>
void ValueSums::move_to_means_of_cards(Value value, float contrast) const {
  if (!(contrast < 1)) return;
  const auto is_odd = [this](std::uint32_t place) { return !is_sampled(place) || is_dark(place); };
  tbb::parallel_for(std::size_t{0}, parts_.count, [&](std::size_t part) {
    const std::span<const std::uint32_t> card = places_of_part_[part];
    if (card.size() > kMostOfCard || std::any_of(card.begin(), card.end(), is_odd)) return;
    auto mean = value(card.front());
    for (const std::uint32_t place : card.subspan(1)) mean += value(place);
    mean /= static_cast<float>(card.size());
    for (const std::uint32_t place : card) value(place) = mean + (value(place) - mean) * contrast;
  });
}

std::vector<PlaceValue> ValueSums::values() const {
  std::vector<PlaceValue> values(of_place_.size());
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    const BothSides& place = of_place_[i];
    if (is_inside(i)) continue;
    if (!is_sampled(i)) {  // without a triangle there is nothing to occlude
      values[i] = {1, V3f(0, 0, 0), true};
      continue;
    }
    if (is_dark(i) && has_inside(i)) continue;
    const float share = share_of_back(i, place);
    const float ao = place.front.mean() + share * (place.back.mean() - place.front.mean());
    // Bent normals of two sides cancel each other: that of the more likely side counts.
    V3f bent = share > 0.5f ? place.back.bent : place.front.bent;
    if (sides_ == BakeSides::mean) bent = bent_of_both(place.front.bent, place.back.bent);
    values[i] = {std::clamp(ao, 0.0f, 1.0f), bent.normalized(), true, is_dark(i)};
  }
  move_to_means_of_cards([&](std::uint32_t place) -> float& { return values[place].ao; },
                         contrast_);
  return values;
}

std::vector<V3f> ValueSums::light_values(std::size_t light) const {
  std::vector<V3f> values(of_place_.size(), V3f(0, 0, 0));
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    if (!is_sampled(i)) continue;
    const float share = share_of_back(i, of_place_[i]);
    const std::size_t at = i * lights_ + light;
    if (share < 1) values[i] += front_light_[at] * ((1 - share) / of_place_[i].front.weight);
    if (share > 0) values[i] += back_light_[at] * (share / of_place_[i].back.weight);
  }
  move_to_means_of_cards([&](std::uint32_t place) -> V3f& { return values[place]; }, contrast_);
  return values;
}

}  // namespace dapple
