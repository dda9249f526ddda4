#include "film/tone_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dapple {
namespace {

float luminance(const V3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// Luminances of the pixels of which at least half is covered, as if all of it were.
std::vector<float> seen_luminances(const Film& film) {
  const Plane *r = film.find("R"), *g = film.find("G"), *b = film.find("B"), *a = film.find("A");
  std::vector<float> seen;
  if (r == nullptr || g == nullptr || b == nullptr) return seen;
  for (std::size_t p = 0; p < r->pixels.size(); ++p) {
    const float alpha = a == nullptr ? 1.0f : a->pixels[p];
    if (!(alpha >= 0.5f)) continue;
    const float value = luminance({r->pixels[p], g->pixels[p], b->pixels[p]}) / alpha;
    if (std::isfinite(value)) seen.push_back(std::max(value, 0.0f));
  }
  return seen;
}

}  // namespace

float automatic_exposure(const Film& film) {
  constexpr double kMiddle = 0.35;
  std::vector<float> seen = seen_luminances(film);
  if (seen.empty()) return 1;
  double sum = 0;
  for (const float value : seen) sum += value;
  const double mean = sum / static_cast<double>(seen.size());
  if (!(mean > 0)) return 1;
  const auto bright = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() * 99 / 100);
  std::nth_element(seen.begin(), bright, seen.end());
  const double scale = std::min(kMiddle / mean, 1.0 / std::max<double>(*bright, mean));
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

V3f sky_color(float height) {
  const V3f horizon(0.78f, 0.86f, 0.93f), zenith(0.22f, 0.42f, 0.78f);
  const float up = std::clamp(height, 0.0f, 1.0f);
  return horizon + (zenith - horizon) * up;
}

}  // namespace dapple
