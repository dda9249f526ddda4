// Statistics of pictures with different seeds. In: values of the pixels. Out: mean, noise and RMS.
#pragma once

#include <vector>

namespace dapple::bench {

/// Sums over pictures of equal size. Only pixels of the mask count.
class PixelStatistics {
 public:
  explicit PixelStatistics(std::vector<bool> mask);

  void add(const std::vector<double>& pixels);

  /// Mean over all pixels and pictures.
  [[nodiscard]] double mean() const;
  /// Standard deviation of a pixel between seeds; root mean square over the pixels.
  [[nodiscard]] double noise() const;
  /// Standard deviation of the picture's mean between seeds.
  [[nodiscard]] double noise_of_mean() const;
  /// Root mean square over the pixels of the mean of infinitely many pictures: the variance of the
  /// mean of the added pictures is subtracted. Needs two pictures.
  [[nodiscard]] double converged_rms() const;
  /// Root mean square over the pixels of a single picture, with noise.
  [[nodiscard]] double rms() const;

 private:
  [[nodiscard]] double mean_variance() const;

  std::vector<bool> mask_;
  std::vector<double> sums_, squares_;
  std::vector<double> picture_means_;
  double pixels_ = 0;
};

/// The median; for an even number of values, the mean of the middle two. `values` must not be
/// empty.
double median(std::vector<double> values);

}  // namespace dapple::bench
