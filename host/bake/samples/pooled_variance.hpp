// The variance of samples as a function of the value that they belong to: that of a few samples of
// one place says little. In: sums of all places. Out: a variance for each side.
#pragma once

#include <array>

#include "bake/samples/side_sums.hpp"

namespace dapple {

/// How samples are taken.
struct Sampling {
  int rays = kRaysPerSample;        ///< of each
  bool several_placements = false;  ///< each sample is in one of them
};

/// Of samples in several placements the variance is the same for all values: where a few samples
/// happen to be in like placements, the value is wrong and its variance small.
class PooledVariance {
 public:
  /// Values are from 0 to `scale`.
  explicit PooledVariance(float scale = 1, const Sampling& sampling = {});

  void add(const SideSums& side);
  PooledVariance& operator+=(const PooledVariance& other);

  /// To be called when all have been added, before of().
  void pool();

  /// Of the samples of `side`, its own deviations included.
  [[nodiscard]] float of(const SideSums& side) const;

 private:
  /// The variance of samples is pooled over values in this many intervals.
  static constexpr int kIntervals = 16;

  struct Pool {
    double squares = 0, freedom = 0;
    void operator+=(const Pool& other) {
      squares += other.squares;
      freedom += other.freedom;
    }
  };

  /// of_samples + of_rays p (1 - p), where p is the share of rays that find nothing.
  struct Line {
    float of_samples = 0, of_rays = 0;
  };

  [[nodiscard]] std::size_t interval(float value) const;
  [[nodiscard]] Pool around(std::size_t interval) const;
  [[nodiscard]] float pooled(float value) const;

  float scale_;
  double of_rays_;
  bool several_placements_;
  std::array<Pool, kIntervals> of_interval_;
  Pool all_;
  std::array<Line, kIntervals> lines_;  ///< of each interval, its neighbours included
};

}  // namespace dapple
