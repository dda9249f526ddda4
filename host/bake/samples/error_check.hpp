// How large errors of values really are, over what the samples of each place tell. Samples of a
// surface are spread over it, so that means of them vary less than independent samples would: their
// own variance tells up to 2.5 times the squared error. In: a second, independent set of samples
// around a few places. Out: the ratio.
#pragma once

#include "bake/samples/sampled_surface.hpp"
#include "bake/samples/value_sums.hpp"

namespace dapple {

class ErrorCheck {
 public:
  /// Compares none of a surface of few places: the second set would take too large a share.
  ErrorCheck(const SampledSurface& surface, std::size_t places, BakeSides sides);

  /// The elements around places that are compared, in ascending order.
  [[nodiscard]] const std::vector<std::uint32_t>& elements() const { return elements_; }

  /// Adds samples of the second set.
  void add(std::vector<SurfaceSample> samples, const TracedSamples& found);

  /// Mean squared error of the places that are compared over the mean of sums.squared_error(),
  /// whose error ratio is 1. 1 if none is compared.
  [[nodiscard]] float ratio(const ValueSums& sums) const;

 private:
  /// Place `place` of the surface is the one of this index in second_; those that are not compared
  /// are the last one there.
  [[nodiscard]] std::uint32_t index_of(std::uint32_t place) const;

  std::vector<std::uint32_t> places_;  ///< in ascending order
  std::vector<std::uint32_t> elements_;
  ValueSums second_;
};

}  // namespace dapple
