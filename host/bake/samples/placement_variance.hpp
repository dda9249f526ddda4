// The variance of means over placements that are taken in turn. In: samples of elements, each in
// one placement. Out: how much smaller the variance of a mean is than that of samples of placements
// at random.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/samples/sample_tracer.hpp"

namespace dapple {

/// Samples of an element take its placements in turn, in a random order. What differs between
/// placements is an error of their mean only as far as some placements have one sample more than
/// others. What differs between samples in one placement always is. Two samples of one element in
/// the same placement tell the two apart.
class PlacementVariance {
 public:
  PlacementVariance(std::size_t elements, std::uint32_t placements);

  /// `front`, `back`: of a sample of `element`; only of the sides that were traced.
  void add(std::uint32_t element, std::uint32_t placement, const SurfaceSample& sample, float front,
           float back);

  /// The share of the variance of an element's samples that is not between placements, (0,1]; 1 as
  /// long as nothing is known.
  [[nodiscard]] float share_within() const;

 private:
  /// Sums of one side of an element that is compared, over samples since the first one.
  struct Side {
    std::uint32_t count = 0, pairs = 0;
    double first = 0, sum = 0, squares = 0;  ///< relative to the first value
    double pair_squares = 0;                 ///< of differences between samples in one placement
  };

  void add_value(std::size_t side, std::uint32_t placement, float value);

  std::uint32_t placements_;
  std::size_t stride_ = 0;   ///< each such element is compared; 0: none
  std::vector<Side> sides_;  ///< front and back of each compared element
  std::vector<float> last_;  ///< by side and placement; NaN: none yet
};

/// The part of the variance between placements that is gone when samples with the barycentric
/// weight of a corner take all placements: of n samples with random weights, which count like 2n/3,
/// what differs in weight is left.
inline constexpr float kBalanceOfCorners = 2 / 3.0f;

/// The variance of the mean of `samples` samples of an element that take its placements in turn,
/// over that of as many independent samples: all of it within placements, and of that between them
/// what is left of the last turn (Cochran, "Sampling Techniques", 1977, section 2.5). `balance`: 1,
/// or kBalanceOfCorners.
float variance_factor(std::uint32_t samples, std::uint32_t placements, float share_within,
                      float balance = 1);

}  // namespace dapple
