#include "render/bias/bias_report.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "film/layers.hpp"
#include "film/light_layers.hpp"
#include "render/bias/unit_grid.hpp"
#include "sampling/bias_estimate.hpp"
#include "scene/images/color.hpp"

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
    count_ += 1;
    squares_ += difference * difference;
    samples_ += samples;
  }
  void add(const PixelError& other) {
    count_ += other.count_;
    squares_ += other.squares_;
    samples_ += other.samples_;
  }
  /// Number of pixels.
  [[nodiscard]] double count() const { return count_; }
  /// Of two pixels or more.
  [[nodiscard]] double value(const std::vector<BiasUnit>& units, double mean, double share) const {
    double squared_counts = 0;
    for (const BiasUnit& unit : units) squared_counts += unit.count * unit.count;
    const double of_rays = std::max(0.0, squares_ - count_ * mean * mean) * count_ / (count_ - 1);
    const double of_choice =
        std::max(0.0, 1 / share - 1) * count_ / samples_ * squared_counts * mean * mean;
    return std::sqrt(of_rays + of_choice) / count_;
  }

 private:
  double count_ = 0, squares_ = 0, samples_ = 0;
};

double total(const std::vector<std::uint32_t>& samples) {
  return static_cast<double>(std::accumulate(samples.begin(), samples.end(), std::uint64_t{0}));
}

/// Estimates the bias of layers of a picture. `per_sample`: rays of a layer that were traced
/// exactly, for each sample.
class BiasEstimate {
 public:
  BiasEstimate(std::span<const std::int64_t> hits, const View& view, double share,
               double per_sample)
      : hits_(hits), grid_(view), share_(share), per_sample_(per_sample) {}

  /// `difference(pixel)`: the sum over the pixel's samples, over the largest value. `samples`: of
  /// each pixel.
  template <class Difference>
  [[nodiscard]] Bias of(const std::vector<std::uint32_t>& samples,
                        const Difference& difference) const {
    std::vector<BiasUnit> units = grid_.empty_units();
    std::vector<PixelError> errors(grid_.row_count());  // added in the same order on any machine
    tbb::parallel_for(std::uint32_t{0}, grid_.row_count(), [&](std::uint32_t row) {
      const PixelRange pixels = grid_.pixels_of_row(row);
      for (std::uint32_t pixel = pixels.begin; pixel < pixels.end; ++pixel) {
        if (hits_[pixel] == 0 || samples[pixel] == 0) continue;
        BiasUnit& unit = units[grid_.unit(pixel)];
        const double mean = difference(pixel) / samples[pixel];
        unit.count += 1;
        unit.difference += mean;
        errors[row].add(mean, samples[pixel]);
      }
    });
    PixelError error;
    for (const PixelError& of_row : errors) error.add(of_row);
    Bias bias = estimate_bias(units, share_);
    const double rays = per_sample_ * total(samples);
    bias.error =
        rays > 0 ? bias_error(error.value(units, bias.mean, share_), error.count(), rays) : 1;
    return bias;
  }

 private:
  std::span<const std::int64_t> hits_;
  UnitGrid grid_;
  double share_, per_sample_;
};

/// A layer of the picture, and its place in PictureBias::passes or, of a group, in groups.
struct NamedBias {
  std::string layer;
  std::size_t index;
  bool is_group;
};

/// Layers that have a bias: "ao", "light.NAME", then "ao.back" and so on.
std::vector<NamedBias> layers_with_bias(const FilmLayout& layout,
                                        const std::vector<Light>& lights) {
  std::vector<NamedBias> found;
  const std::size_t of_ao = layout.ao ? 1 : 0, of_side = of_ao + lights.size();
  for (std::size_t side = 0; side < (layout.back_samples ? 2 : 1); ++side) {
    const std::string back = side == 0 ? "" : ".back";
    std::size_t group = side * layout.groups.size();
    if (layout.ao) found.push_back({"ao" + back, side * of_side, false});
    for (const LightLayer& layer : light_layers(lights)) {
      const bool is_group = layer.lights.size() > 1;
      found.push_back({"light." + layer.name + back,
                       is_group ? group++ : side * of_side + of_ao + layer.lights[0], is_group});
    }
  }
  return found;
}

std::string no_bias_note(const std::string& resumed) {
  const std::string none = "the bias is not reported: ";
  if (resumed.empty())
    return none + "too few rays were traced exactly; --report-bias 100% takes all";
  return fmt::format(
      "{}this run adds too few exact rays to those of {}, which are not kept; the "
      "picture made with it has their bias",
      none, resumed);
}

/// The noise and the bias of each pass with a known noise, together.
void add_whole_errors(RenderStatistics& statistics, const PictureBias& bias, double seen,
                      const FilmLayout& layout, const std::vector<Light>& lights) {
  std::vector<std::string> passes;
  if (layout.ao) passes.emplace_back("ao");
  for (const std::string& name : light_names(lights)) passes.push_back("light." + name);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const auto noise = statistics.rmse.find(passes[i]);
    if (noise == statistics.rmse.end()) continue;
    statistics.rmse_with_bias[passes[i]] =
        std::sqrt(noise->second * noise->second + seen * mean_square(bias.passes[i]));
  }
}

}  // namespace

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

void add_largest_irradiances(RenderStatistics& statistics, const std::vector<double>& largest,
                             const FilmLayout& layout, const std::vector<Light>& lights) {
  if (largest.empty()) return;
  const std::size_t of_ao = layout.ao ? 1 : 0;
  std::size_t group = of_ao + lights.size();  // at their radiances
  for (const LightLayer& layer : light_layers(lights)) {
    const std::size_t light = layer.lights[0];
    statistics.largest_irradiance["light." + layer.name] =
        layer.lights.size() > 1 ? largest[group++]
                                : largest[of_ao + light] * luminance(lights[light].radiance);
  }
}

void add_bias(RenderResult& result, const TracedPicture& picture, const FilmLayout& layout,
              const std::vector<Light>& lights, const std::string& resumed) {
  RenderStatistics& statistics = result.statistics;
  const Plane& alpha = *result.film.find("A");
  const auto seen = std::count_if(alpha.pixels.begin(), alpha.pixels.end(),
                                  [](float value) { return value > 0; });
  if (picture.bias.passes.empty()) {
    if (seen > 0 && statistics.footprint > 0) statistics.notes.push_back(no_bias_note(resumed));
    return;
  }
  for (const NamedBias& named : layers_with_bias(layout, lights)) {
    const Bias& bias = (named.is_group ? picture.bias.groups : picture.bias.passes)[named.index];
    statistics.bias[named.layer] = bias;
    result.film.metadata.settings.emplace_back("bias." + named.layer, bias_text(bias));
  }
  const double share = static_cast<double>(seen) / static_cast<double>(alpha.pixels.size());
  add_whole_errors(statistics, picture.bias, share, layout, lights);
}

PictureBias picture_bias(const BiasSums& sums, const HostView& film, const SideSamples& samples,
                         const FilmLayout& layout, const View& view,
                         const std::vector<double>& largest) {
  if (sums.exact_rays < kLeastRays) return {};
  const std::size_t layers = sums.differences.size();
  const std::size_t sides = samples.backs.empty() ? 1 : 2, of_side = layers / sides;
  const double all_samples = total(samples.fronts) + total(samples.backs);
  const BiasEstimate estimate(film.values<std::int64_t>().first(layout.pixels), view,
                              sums.exact_rays / sums.rays,
                              sums.exact_rays / (static_cast<double>(of_side) * all_samples));
  const auto divisor = [&](std::size_t i) { return largest[i] > 0 ? largest[i] : 1.0; };
  PictureBias out;
  for (std::size_t side = 0; side < sides; ++side) {
    const std::vector<std::uint32_t>& of_samples = side == 0 ? samples.fronts : samples.backs;
    const auto* const differences = &sums.differences[side * of_side];
    for (std::size_t layer = 0; layer < of_side; ++layer)
      out.passes.push_back(estimate.of(of_samples, [&](std::uint32_t pixel) {
        return double{differences[layer][pixel]} / divisor(layer);
      }));
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
      const LightGroup& group = layout.groups[g];
      out.groups.push_back(estimate.of(of_samples, [&](std::uint32_t pixel) {
        double sum = 0;
        for (std::size_t i = 0; i < group.lights.size(); ++i)
          sum += group.luminances[i] *
                 double{differences[group.lights[i] + (layout.ao ? 1 : 0)][pixel]};
        return sum / divisor(of_side + g);
      }));
    }
  }
  return out;
}

}  // namespace dapple
