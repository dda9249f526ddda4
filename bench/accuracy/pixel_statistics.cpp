#include "accuracy/pixel_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dapple::bench {

PixelStatistics::PixelStatistics(std::vector<bool> mask)
    : mask_(std::move(mask)), sums_(mask_.size()), squares_(mask_.size()) {
  pixels_ = static_cast<double>(
      std::max<std::ptrdiff_t>(1, std::count(mask_.begin(), mask_.end(), true)));
}

void PixelStatistics::add(const std::vector<double>& pixels) {
  double total = 0;
  for (std::size_t p = 0; p < mask_.size(); ++p) {
    if (!mask_[p]) continue;
    sums_[p] += pixels[p];
    squares_[p] += pixels[p] * pixels[p];
    total += pixels[p];
  }
  picture_means_.push_back(total / pixels_);
}

double PixelStatistics::mean() const {
  return std::accumulate(picture_means_.begin(), picture_means_.end(), 0.0) /
         static_cast<double>(picture_means_.size());
}

double PixelStatistics::mean_variance() const {
  const auto n = static_cast<double>(picture_means_.size());
  if (n < 2) return 0;
  double sum = 0;
  for (std::size_t p = 0; p < mask_.size(); ++p)
    sum += (squares_[p] - sums_[p] * sums_[p] / n) / (n - 1);
  return std::max(0.0, sum / pixels_);
}

double PixelStatistics::noise() const { return std::sqrt(mean_variance()); }

double PixelStatistics::noise_of_mean() const {
  const auto n = static_cast<double>(picture_means_.size());
  if (n < 2) return 0;
  double squares = 0;
  for (const double value : picture_means_) squares += (value - mean()) * (value - mean());
  return std::sqrt(squares / (n - 1));
}

double PixelStatistics::converged_rms() const {
  const auto n = static_cast<double>(picture_means_.size());
  double square = 0;
  for (const double sum : sums_) square += sum * sum / (n * n);
  return std::sqrt(std::max(0.0, square / pixels_ - mean_variance() / n));
}

double PixelStatistics::rms() const {
  const auto n = static_cast<double>(picture_means_.size());
  return std::sqrt(std::accumulate(squares_.begin(), squares_.end(), 0.0) / (n * pixels_));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

}  // namespace dapple::bench
