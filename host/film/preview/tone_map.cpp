#include "film/preview/tone_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "scene/images/color.hpp"

namespace dapple {
namespace {

/// What a pixel shows where it is covered, how much of it is, and that weighted for the exposure.
struct Seen {
  float luminance, peak, alpha, weight;  ///< peak: of the brightest channel
};

/// The middle of the whole picture counts more, as in the light meters of cameras: a Gaussian of
/// 0.18 of its width and height.
class CentreWeights {
 public:
  explicit CentreWeights(const Film& film)
      : columns_(weights(film.data_window.x0, film.data_window.x1, film.width)),
        rows_(weights(film.data_window.y0, film.data_window.y1, film.height)) {}
  [[nodiscard]] float of(std::size_t pixel) const {
    return columns_[pixel % columns_.size()] * rows_[pixel / columns_.size()];
  }

 private:
  /// Of the pixels of the data window, which may reach beyond the picture's `size`.
  static std::vector<float> weights(int first, int last, int size) {
    constexpr double kDeviation = 0.18, kFarthest = 2;
    std::vector<float> of;
    for (std::int64_t i = first; i <= last; ++i) {
      const double off = (static_cast<double>(i) + 0.5) / std::max(size, 1) - 0.5;
      const double near = std::clamp(off, -kFarthest, kFarthest);
      of.push_back(static_cast<float>(std::exp(-near * near / (2 * kDeviation * kDeviation))));
    }
    return of;
  }

  std::vector<float> columns_, rows_;
};

std::vector<Seen> seen_luminances(const Film& film) {
  const Plane *r = film.find("R"), *g = film.find("G"), *b = film.find("B"), *a = film.find("A");
  std::vector<Seen> seen;
  if (r == nullptr || g == nullptr || b == nullptr) return seen;
  const CentreWeights centre(film);
  for (std::size_t p = 0; p < r->pixels.size(); ++p) {
    const float alpha = a == nullptr ? 1.0f : std::min(a->pixels[p], 1.0f);
    if (!(alpha > 0)) continue;
    const auto value = static_cast<float>(luminance(V3f(r->pixels[p], g->pixels[p], b->pixels[p])) /
                                          double{alpha});
    const float peak = std::max({r->pixels[p], g->pixels[p], b->pixels[p]}) / alpha;
    if (std::isfinite(value) && std::isfinite(peak))
      seen.push_back({std::max(value, 0.0f), std::max(peak, 0.0f), alpha, alpha * centre.of(p)});
  }
  return seen;
}

/// What a hundredth of what is seen exceeds in one channel, wherever it is.
double bright_peak(std::vector<Seen> seen) {
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.peak > b.peak; });
  double covered = 0, brighter = 0;
  for (const Seen& pixel : seen) covered += double{pixel.alpha};
  for (const Seen& pixel : seen) {
    brighter += double{pixel.alpha};
    if (brighter > 0.01 * covered) return double{pixel.peak};
  }
  return 0;
}

/// Mean luminance of the albedo of what is seen, [0,1]; that of a middle grey without the layer.
double mean_albedo(const Film& film) {
  constexpr double kMiddleGrey = 0.5;
  const Plane *r = film.find("albedo.R"), *g = film.find("albedo.G"), *b = film.find("albedo.B");
  const Plane* a = film.find("A");
  if (r == nullptr || g == nullptr || b == nullptr || a == nullptr) return kMiddleGrey;
  const CentreWeights centre(film);
  double sum = 0, weight = 0;
  for (std::size_t p = 0; p < r->pixels.size(); ++p) {
    const double alpha = double{a->pixels[p]};
    const double value = luminance(V3f(r->pixels[p], g->pixels[p], b->pixels[p]));
    if (!(alpha > 0) || !std::isfinite(value)) continue;
    sum += alpha * value * double{centre.of(p)};
    weight += alpha * double{centre.of(p)};
  }
  return weight > 0 ? std::clamp(sum / weight, 0.01, 1.0) : kMiddleGrey;
}

}  // namespace

float automatic_exposure(const Film& film) {
  constexpr double kMiddle = 0.35, kMiddleGrey = 0.5;
  const std::vector<Seen> seen = seen_luminances(film);
  double sum = 0, weight = 0;
  for (const Seen& pixel : seen) {
    sum += double{pixel.luminance} * double{pixel.weight};
    weight += double{pixel.weight};
  }
  if (!(sum > 0)) return 1;
  const double mean = sum / weight;
  const double shown = kMiddle * std::sqrt(mean_albedo(film) / kMiddleGrey);
  const double scale = std::min(shown / mean, 1.0 / std::max(bright_peak(seen), mean));
  return std::isfinite(static_cast<float>(scale)) ? static_cast<float>(scale) : 1;
}

V3f tone_mapped(V3f color) {
  constexpr float kStart = 0.76f, kDesaturation = 0.15f;
  for (int channel = 0; channel < 3; ++channel)
    color[channel] = color[channel] > 0 ? std::min(color[channel], 1e30f) : 0.0f;  // NaN: 0
  const float peak = std::max({color.x, color.y, color.z});
  if (peak <= kStart) return color;
  constexpr float kRoom = 1 - kStart;
  const float to = 1 - kRoom * kRoom / (peak + kRoom - kStart);
  const float kept = 1 / (kDesaturation * (peak - to) + 1);
  return color * (to / peak * kept) + V3f(to) * (1 - kept);
}

V3f backdrop_color(float elevation) {
  const V3f horizon(0.72f, 0.80f, 0.87f), zenith(0.12f, 0.30f, 0.68f), ground(0.33f, 0.33f, 0.32f);
  const float away = 1 - std::exp(-4 * std::fabs(elevation));
  return horizon + ((elevation > 0 ? zenith : ground) - horizon) * away;
}

}  // namespace dapple
