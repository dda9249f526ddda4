// How large errors of values really are, over what the samples of each place tell. Samples of a
// surface are spread over it, so that means of them vary less than independent samples would: their
// own variance tells up to 2.5 times the squared error. And how much of the differences within
// cards is noise. In: a second, independent set of samples around a few places. Out: both.
#pragma once

#include <span>
#include <vector>

#include "bake/samples/sampled_surface.hpp"
#include "bake/samples/value_sums.hpp"

namespace dapple {

/// What two sets of samples tell.
struct ErrorFit {
  /// The part of the differences between a card's places that is not noise, [0,1].
  float contrast = 1;
  /// Mean squared error of the places that are compared, with that contrast and the same weights of
  /// their sides in both sets, over ValueSums::squared_noise().
  float ratio = 1;
};

class ErrorCheck {
 public:
  /// Compares none of a surface of few places: the second set would take too large a share.
  ErrorCheck(const SampledSurface& surface, const ValueSums& sums, BakeSides sides);

  /// The elements around places that are compared, in ascending order.
  [[nodiscard]] const std::vector<std::uint32_t>& elements() const { return elements_; }

  /// Adds samples of the second set.
  void add(std::vector<SurfaceSample> samples, const TracedSamples& found);

  /// `sums`: of the first set. If none is compared, both figures are 1.
  [[nodiscard]] ErrorFit fit(const ValueSums& sums) const;

 private:
  /// Place `place` of the surface is the one of this index in second_; those that are not compared
  /// are the last one there.
  [[nodiscard]] std::uint32_t index_of(std::uint32_t place) const;

  /// Differences between both sets.
  struct Differences {
    double told = 0;         ///< squared noise, as samples tell it
    double squares = 0;      ///< squared errors of single places and of means of cards
    double own = 0;          ///< squares of a card's differences from its mean, of one set
    double cross = 0;        ///< products of those of both sets
    std::size_t places = 0;  ///< that are compared
    std::size_t of_cards = 0;
  };
  void compare(const ValueSums& sums, std::span<const std::uint32_t> places,
               Differences& differences) const;

  std::vector<std::uint32_t> places_;  ///< in ascending order; of cards all or none
  std::vector<std::uint32_t> elements_;
  ValueSums second_;
};

}  // namespace dapple
