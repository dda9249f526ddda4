#include "render/bias_report.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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

double total(const std::vector<std::uint32_t>& samples) {
  return static_cast<double>(std::accumulate(samples.begin(), samples.end(), std::uint64_t{0}));
}

}  // namespace

std::vector<std::string> bias_layers(const FilmLayout& layout, const std::vector<Light>& lights) {
  std::vector<std::string> names;
  if (layout.ao) names.emplace_back("ao");
  for (const std::string& name : light_names(lights)) names.push_back("light." + name);
  if (!layout.back_samples) return names;
  const std::size_t front = names.size();
  for (std::size_t i = 0; i < front; ++i) names.push_back(names[i] + ".back");
  return names;
}

SideSamples samples_of_bias(const BiasSums& sums, const HostView& film,
                            const std::vector<std::uint32_t>& samples, const FilmLayout& layout,
                            std::uint32_t group_bits) {
  SideSamples taken{samples, {}};
  if (layout.back_samples) {
    const auto backs =
        film.values<std::int64_t>().subspan(std::size_t{layout.back_samples} * layout.pixels);
    taken.backs.assign(backs.begin(), backs.begin() + layout.pixels);
  }
  for (std::size_t pixel = 0; pixel < sums.earlier.size(); ++pixel) {
    const std::uint32_t earlier = sums.earlier[pixel];
    taken.fronts[pixel] -= earlier;
    if (!taken.backs.empty())
      taken.backs[pixel] -= std::min(taken.backs[pixel], earlier >> group_bits);
  }
  return taken;
}

std::vector<Bias> picture_bias(const BiasSums& sums, const HostView& film,
                               const SideSamples& samples, const FilmLayout& layout,
                               const View& view, const std::vector<double>& divisors) {
  if (sums.exact_rays < kLeastRays) return {};
  const std::span<const std::int64_t> hits = film.values<std::int64_t>().first(layout.pixels);
  const UnitGrid grid(view);
  const double share = sums.exact_rays / sums.rays;
  const std::size_t layers = sums.differences.size();
  const std::size_t in_front = samples.backs.empty() ? layers : layers / 2;
  const double of_front = total(samples.fronts), of_back = total(samples.backs);
  const double per_sample =
      sums.exact_rays / (static_cast<double>(in_front) * (of_front + of_back));
  std::vector<Bias> out;
  for (std::size_t layer = 0; layer < layers; ++layer) {
    const std::vector<std::uint32_t>& of_layer = layer < in_front ? samples.fronts : samples.backs;
    std::vector<BiasUnit> units = grid.empty_units();
    std::vector<PixelError> errors(grid.row_count());  // added in the same order on any machine
    tbb::parallel_for(std::uint32_t{0}, grid.row_count(), [&](std::uint32_t row) {
      const PixelRange pixels = grid.pixels_of_row(row);
      for (std::uint32_t pixel = pixels.begin; pixel < pixels.end; ++pixel) {
        const std::uint32_t taken = of_layer[pixel];
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
    const double rays_of_layer = per_sample * (layer < in_front ? of_front : of_back);
    bias.error =
        rays_of_layer > 0 ? std::hypot(error.value(units, bias.mean, share), 1 / rays_of_layer) : 1;
    out.push_back(bias);
  }
  return out;
}

}  // namespace dapple
