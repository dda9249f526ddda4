#include "render/bias_report.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "film/layers.hpp"
#include "render/unit_grid.hpp"

namespace dapple {

namespace {

/// Fewer rays say nothing about a bias: most differences are 0.
constexpr double kLeastRays = 32;

/// The standard error of the mean over pixels. Rays of different pixels are independent, and there
/// are many more pixels than units, so that few rays tell it. What pixels of a unit have in common
/// is that they are chosen together: that adds what independent choices of its samples would.
class PixelError {
 public:
  void add(double difference, double samples) {
    squares_ += difference * difference;
    samples_ += samples;
  }
  void add(const PixelError& other) {
    squares_ += other.squares_;
    samples_ += other.samples_;
  }
  [[nodiscard]] double value(const std::vector<BiasUnit>& units, double mean, double share) const {
    double count = 0, squared_counts = 0;
    for (const BiasUnit& unit : units) {
      count += unit.count;
      squared_counts += unit.count * unit.count;
    }
    if (count < 2) return 0;
    const double of_rays = std::max(0.0, squares_ - count * mean * mean) * count / (count - 1);
    const double of_choice =
        std::max(0.0, 1 / share - 1) * count / samples_ * squared_counts * mean * mean;
    return std::sqrt(of_rays + of_choice) / count;
  }

 private:
  double squares_ = 0, samples_ = 0;
};

}  // namespace

std::vector<std::string> bias_layers(const FilmLayout& layout, const std::vector<Light>& lights) {
  std::vector<std::string> names;
  if (layout.ao) names.emplace_back("ao");
  for (const std::string& name : light_names(lights)) names.push_back("light." + name);
  if (!layout.back_squares) return names;
  const std::size_t front = names.size();
  for (std::size_t i = 0; i < front; ++i) names.push_back(names[i] + ".back");
  return names;
}

std::vector<Bias> picture_bias(const BiasSums& sums, const HostView& film,
                               const std::vector<std::uint32_t>& samples, const FilmLayout& layout,
                               const View& view, const std::vector<double>& divisors) {
  if (sums.exact_rays < kLeastRays) return {};
  const std::span<const std::int64_t> hits = film.values<std::int64_t>().first(layout.pixels);
  const UnitGrid grid(view);
  const double share = sums.exact_rays / sums.rays;
  std::vector<Bias> out;
  for (std::size_t layer = 0; layer < sums.differences.size(); ++layer) {
    std::vector<BiasUnit> units = grid.empty_units();
    std::vector<PixelError> errors(grid.row_count());  // added in the same order on any machine
    tbb::parallel_for(std::uint32_t{0}, grid.row_count(), [&](std::uint32_t row) {
      const PixelRange pixels = grid.pixels_of_row(row);
      for (std::uint32_t pixel = pixels.begin; pixel < pixels.end; ++pixel) {
        const std::uint32_t taken =
            samples[pixel] - (sums.earlier.empty() ? 0u : sums.earlier[pixel]);
        if (hits[pixel] == 0 || taken == 0) continue;
        BiasUnit& unit = units[grid.unit(pixel)];
        const double difference =
            double{sums.differences[layer][pixel]} / (taken * divisors[layer]);
        unit.count += 1;
        unit.difference += difference;
        errors[row].add(difference, taken);
      }
    });
    PixelError error;
    for (const PixelError& of_row : errors) error.add(of_row);
    Bias bias = estimate_bias(units, share);
    // One ray more could have differed by all of its light: rare differences may not be seen.
    const double rays_of_layer = sums.exact_rays / static_cast<double>(sums.differences.size());
    bias.error = std::hypot(error.value(units, bias.mean, share), 1 / rays_of_layer);
    out.push_back(bias);
  }
  return out;
}

}  // namespace dapple
