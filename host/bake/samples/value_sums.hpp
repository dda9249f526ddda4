// Turns results at samples into values of places, which are vertices or texels. In: AO and bent
// normals, or irradiance, of both sides of each sample. Out: one value for each place, and how many
// more samples it needs.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "bake/samples/pooled_variance.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// The small connected parts of a surface, such as leaves, that its places belong to.
struct SmallParts {
  static constexpr std::uint32_t kLarge = ~0u;
  std::vector<std::uint32_t> of_place;  ///< kLarge: of a part that is not small
  std::size_t count = 0;
};

/// The places of each small part, in ascending order.
class PlacesOfParts {
 public:
  explicit PlacesOfParts(const SmallParts& parts);
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t part) const {
    return std::span(places_).subspan(begin_[part], begin_[part + 1] - begin_[part]);
  }

 private:
  std::vector<std::uint32_t> begin_, places_;
};

/// The value of a place.
struct PlaceValue {
  float ao = 0;
  V3f bent{0, 0, 0};   ///< unit length, or zero
  bool known = false;  ///< false: inside closed geometry, from where nothing is seen
  bool dark = false;   ///< known, and nothing is seen from there, as in a closed room
};

class ValueSums {
 public:
  /// `lights`: 0 for AO; else the scalar of a sample is the brightness of so many lights.
  ValueSums(SmallParts parts, BakeSides sides, std::size_t lights = 0);

  /// Number of places.
  [[nodiscard]] std::size_t size() const { return of_place_.size(); }

  void set_sampling(const Sampling& sampling) { sampling_ = sampling; }

  /// By what the squared noise that samples tell is to be multiplied, and the part of the
  /// differences within cards that is not noise, [0,1]: error_check.hpp.
  void set_noise_ratio(float ratio) { noise_ratio_ = ratio; }
  void set_contrast(float contrast) { contrast_ = contrast; }

  /// The places of a small part that has few of them, such as the corners of a leaf, in ascending
  /// order; empty: the place belongs to a larger part.
  [[nodiscard]] std::span<const std::uint32_t> card_of(std::uint32_t place) const;

  /// For each place variance_factor() of its samples; without them, all 1.
  void set_variance_factors(std::vector<float> factors) { factors_ = std::move(factors); }

  /// Adds what was found at samples on the sides that were traced. Those inside closed geometry do
  /// not count for values.
  void add(std::span<const SurfaceSample> samples, const TracedSamples& found);

  /// Learns how far samples vary. Weighs the sides of each small part, and of each place of larger
  /// ones, by the probability that they are the brighter one, from the samples so far. For
  /// BakeSides::mean both count the same. `target_error`: that of missing_samples().
  void choose_sides(float target_error = 0);

  /// Whether a side of a place is to be sampled: it seems to be the brighter one, or the regret of
  /// not knowing is large beside the target.
  [[nodiscard]] bool is_wanted(std::uint32_t place, bool back) const;

  /// Whether a place has samples that count.
  [[nodiscard]] bool is_sampled(std::uint32_t place) const {
    return of_place_[place].front.weight > 0 || of_place_[place].back.weight > 0;
  }

  /// Whether samples of a place lie inside closed geometry.
  [[nodiscard]] bool has_inside(std::uint32_t place) const {
    return of_place_[place].inside_weight > 0;
  }

  /// Whether all samples of a place do.
  [[nodiscard]] bool is_inside(std::uint32_t place) const {
    return has_inside(place) && !is_sampled(place);
  }

  /// The squared standard error of a place's scalar for these weights of its sides, estimated from
  /// its samples and from those of places of similar value, as choose_sides() found them; relative
  /// to the largest unoccluded value so far (of AO: 1).
  [[nodiscard]] float squared_noise(std::uint32_t place) const;

  /// The squared errors of values() and light_values(): noise times its ratio, which differs less
  /// within a card, and the regret of taking the darker side for the brighter one.
  [[nodiscard]] std::vector<float> squared_errors() const;

  /// The scalar of a place, of both sides by their shares, relative to the same value. Of samples
  /// of `other` if given, whose place `at` is the same one.
  [[nodiscard]] float scalar(std::uint32_t place) const { return scalar(place, of_place_[place]); }
  [[nodiscard]] float scalar(std::uint32_t place, const ValueSums& other, std::uint32_t at) const {
    return scalar(place, other.of_place_[at]);
  }

  /// For each place, by what factor the number of its samples must grow for a standard error of
  /// `target`; 1: enough. Places that seem to see nothing need a few.
  [[nodiscard]] std::vector<float> missing_samples(float target) const;

  /// The values of all places; those of a card differ by their contrast. Places without samples
  /// have AO 1: there is nothing to occlude.
  [[nodiscard]] std::vector<PlaceValue> values() const;

  /// The irradiance of a light at all places; 0 at places without samples.
  [[nodiscard]] std::vector<V3f> light_values(std::size_t light) const;

 private:
  /// Which side is the brighter one.
  struct SideChoice {
    float share_of_back = 0.5f;  ///< [0,1], the weight of the back in the value: its probability
    float regret = std::numeric_limits<float>::infinity();  ///< expected square of what is lost by
                                                            ///< choosing the likelier one
  };

  /// How much brighter the backs of places are than their fronts: sums over places that have both.
  struct BackMinusFront {
    float difference = 0, square_error = 0;
    std::size_t places = 0;
    void add(const BothSides& values, const PooledVariance& variance);
    [[nodiscard]] SideChoice choice() const;
  };

  void add(const SurfaceSample& sample, const TracedSamples& found, std::size_t index);
  void add_inside(const SurfaceSample& sample);
  [[nodiscard]] float scale() const { return largest_ > 0 ? largest_ : 1; }
  [[nodiscard]] bool is_dark(std::uint32_t place) const;
  template <class Value>
  void move_to_means_of_cards(Value value, float contrast) const;
  [[nodiscard]] PooledVariance pooled_variance() const;
  /// The back's weight of a place, of whose sides `sums` may lack samples.
  [[nodiscard]] float share_of_back(std::uint32_t place, const BothSides& sums) const;
  [[nodiscard]] float scalar(std::uint32_t place, const BothSides& sums) const;

  BakeSides sides_;
  SmallParts parts_;
  PlacesOfParts places_of_part_;
  std::vector<BothSides> of_place_;
  std::vector<SideChoice> choice_;  ///< by place
  std::vector<float> factors_;      ///< by place, of the variance of means; empty: 1
  Sampling sampling_;
  PooledVariance variance_;  ///< when sides were chosen
  float noise_ratio_ = 1, contrast_ = 1;
  float tolerated_regret_ = 0;
  float largest_ = 0;  ///< the largest TracedSamples::largest
  std::size_t lights_;
  std::vector<V3f> front_light_, back_light_;  ///< weighted sums, the lights of a place together
};

}  // namespace dapple
