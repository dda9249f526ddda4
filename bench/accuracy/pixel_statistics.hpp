// Pictures of many seeds, pixel by pixel: what is left of them in the mean, and the noise.
#pragma once

#include <vector>

namespace dapple::bench {

/// Running sums of pictures of equal size; only pixels of the mask count.
class PixelStatistics {
 public:
  explicit PixelStatistics(std::vector<bool> mask);

  void add(const std::vector<double>& pixels);

  /// Over all pixels and pictures.
  [[nodiscard]] double mean() const;
  /// Standard deviation from seed to seed of a pixel, root mean square over the pixels.
  [[nodiscard]] double noise() const;
  /// Standard deviation from seed to seed of the picture's mean.
  [[nodiscard]] double noise_of_mean() const;
  /// Root mean square over the pixels of what infinitely many pictures would average to:
  /// the variance that remains in the mean of those added is taken out. Needs two pictures.
  [[nodiscard]] double converged_rms() const;
  /// The same of a single picture: noise included.
  [[nodiscard]] double rms() const;

 private:
  [[nodiscard]] double mean_variance() const;

  std::vector<bool> mask_;
  std::vector<double> sums_, squares_;
  std::vector<double> picture_means_;
  double pixels_ = 0;
};

/// Middle of the values, of an even number the mean of the two. There must be one.
double median(std::vector<double> values);

}  // namespace dapple::bench
