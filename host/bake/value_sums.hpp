// From what was found at samples to values of places: vertices or texels. In: AO and bent normals
// of samples, both sides. Out: one value for each place, and how many more samples it needs.
#pragma once

#include <vector>

#include "bake/sample_tracer.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// The small connected parts of a surface, such as leaves, that its places belong to.
struct SmallParts {
  static constexpr std::uint32_t kLarge = ~0u;
  std::vector<std::uint32_t> of_place;  ///< kLarge: of a part that is not small
  std::size_t count = 0;
};

/// The value of a place.
struct PlaceValue {
  float ao = 0;
  V3f bent{0, 0, 0};   ///< unit length, or zero
  bool known = false;  ///< false: inside closed geometry, from where nothing is seen
};

class ValueSums {
 public:
  ValueSums(SmallParts parts, BakeSides sides);

  /// Adds what one sample found on the sides that were traced.
  void add(const SurfaceSample& sample, const SideValue& front, const SideValue& back);

  /// Chooses the brighter side of each small part and of each place of larger ones, from the
  /// samples so far. `surely`: only where the difference is significant. Sides that were not chosen
  /// from, and all sides for BakeSides::mean, count both.
  void choose_sides(bool surely);

  /// Whether a side of a place counts for its value.
  [[nodiscard]] bool counts(std::uint32_t place, bool back) const {
    return chosen_[place] == Chosen::both || (chosen_[place] == Chosen::back) == back;
  }

  /// The squared standard error of each place's AO, estimated from its samples and from those of
  /// places of similar AO.
  [[nodiscard]] std::vector<float> squared_errors() const;

  /// For each place, by what factor the number of its samples must grow for a standard error of
  /// `target`; 1: enough. Places that may be hidden need more than others.
  [[nodiscard]] std::vector<float> missing_samples(float target) const;

  /// The values of all places. Places without samples have AO 1: there is nothing to occlude.
  [[nodiscard]] std::vector<PlaceValue> values() const;

 private:
  /// Sums over the samples of one side.
  struct Side {
    float weight = 0, weight_squares = 0, ao = 0, ao_squares = 0;
    V3f bent{0, 0, 0};
    void add(float w, const SideValue& value);
    [[nodiscard]] float mean() const { return weight > 0 ? ao / weight : 0; }
    /// Number of samples of equal weight that would have the same standard error.
    [[nodiscard]] float count() const;
    /// Sum of squared deviations, for count() - 1 degrees of freedom.
    [[nodiscard]] float squared_deviations() const;
  };
  struct BothSides {
    Side front, back;
  };
  enum class Chosen : std::uint8_t { both, front, back };
  class PooledVariance;

  [[nodiscard]] PooledVariance pooled_variance() const;

  BakeSides sides_;
  SmallParts parts_;
  std::vector<BothSides> of_place_;
  std::vector<BothSides> of_part_;
  std::vector<Chosen> chosen_;  ///< by place
};

}  // namespace dapple
