#include "sampling/film_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sampling/batch_variance.hpp"
#include "sampling/pixel_neighbourhood.hpp"

namespace dapple {
std::vector<std::vector<float>> FilmMoments::variances() const {
  std::vector<std::vector<float>> out;
  if (options_.ao) out.push_back(ao_variances());
  for (std::size_t light = 0; light < layout_.lights.size(); ++light) {
    LightVariances of_light = light_variances(light);
    const double factor = 1.0 / (of_light.largest * of_light.largest);
    for (float& variance : of_light.absolute) variance = static_cast<float>(variance * factor);
    out.push_back(std::move(of_light.absolute));
  }
  return out;
}

std::vector<double> FilmMoments::largest_values() const {
  std::vector<double> out(options_.ao ? 1 : 0, 1.0);
  for (std::size_t light = 0; light < layout_.lights.size(); ++light)
    out.push_back(light_variances(light).largest);
  return out;
}

// Occlusion is 0 where samples missed.
std::vector<float> FilmMoments::ao_variances() const {
  const double scale = 1.0 / (double{layout_.unit_scale} * options_.ao_rays);
  return variances_of(
      [&](std::uint32_t p) { return mean(sum(0, p) - sum(layout_.ao, p) * scale, p); }, 0);
}

FilmMoments::LightVariances FilmMoments::light_variances(std::size_t light) const {
  const LightPlaneRange& planes = layout_.lights[light];
  const double scale = 1.0 / (double{layout_.light_scale} * options_.light_rays);
  const auto irradiance = [&](std::uint32_t p) {
    return mean(luminance_sum(planes.first, planes.channels, p) * scale, p);
  };
  std::vector<float> variances = variances_of(irradiance, layout_.light_squares(light));
  const double largest = largest_unoccluded(planes, scale, variances);
  return {std::move(variances), largest};
}

// The largest of noisy means is biased upwards. So each mean counts less its standard error,
// estimated from the occluded irradiance, but not less than the mean of its neighbours (experiment
// 503). For pilot pixels the largest mean is used, because pixels between them may be brighter.
double FilmMoments::largest_unoccluded(const LightPlaneRange& planes, double scale,
                                       const std::vector<float>& variances) const {
  const bool only_pilot = std::find(samples_.begin(), samples_.end(), 0u) != samples_.end();
  const auto unoccluded = [&](std::size_t p) -> std::array<float, 2> {
    if (samples_[p] == 0) return {};
    const auto pixel = static_cast<std::uint32_t>(p);
    return {static_cast<float>(luminance_sum(planes.unoccluded(), planes.channels, pixel) * scale),
            static_cast<float>(sum(0, pixel))};
  };
  std::vector<float> of_rows(layout_.pixels / static_cast<std::uint32_t>(width_));
  visit_neighbourhoods(
      layout_.pixels, width_, unoccluded,
      [&](std::size_t p, const std::array<float, 2>& own, const std::array<float, 2>& around) {
        if (own[1] == 0) return;
        const auto samples = static_cast<float>(samples_[p]);
        const float mean = own[0] / samples, by_others = around[0] / around[1] * own[1] / samples;
        const float error =
            only_pilot ? 0.0f : std::sqrt(variances[p] * DAPPLE_SAMPLE_BATCH / samples);
        float& max_of_row = of_rows[p / static_cast<std::size_t>(width_)];
        max_of_row = std::max({max_of_row, mean - error, std::min(mean, by_others)});
      });
  const double largest = *std::max_element(of_rows.begin(), of_rows.end());
  return largest > 0 ? largest : 1.0;
}

template <class Mean>
std::vector<float> FilmMoments::variances_of(const Mean& mean, std::uint32_t squares_plane) const {
  const std::span<const float> squares = squares_.subspan(
      std::size_t{squares_plane} * layout_.pixels, 2 * std::size_t{layout_.pixels});
  const auto moments = [&](std::size_t p) {
    if (squares[p] == 0) return BatchMoments{};  // all of its batches are 0
    const double of_pixel = mean(static_cast<std::uint32_t>(p));
    return BatchMoments{static_cast<float>(of_pixel), squares[p], squares[p + layout_.pixels]};
  };
  return batch_variances(samples_, width_, moments);
}

}  // namespace dapple
