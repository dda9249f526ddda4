#include "sampling/film_moments.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sampling/batch_variance.hpp"
#include "sampling/pixel_neighbourhood.hpp"

namespace dapple {

template <class Mean>
BatchMoments FilmMoments::moments(const Mean& mean, std::uint32_t squares_plane,
                                  std::size_t pixel) const {
  const float* const squares = &squares_[std::size_t{squares_plane} * layout_.pixels + pixel];
  if (*squares == 0) return {};  // all of its batches are 0
  return {static_cast<float>(mean(static_cast<std::uint32_t>(pixel))), *squares,
          squares[layout_.pixels]};
}

std::vector<std::vector<float>> FilmMoments::variances() const {
  std::vector<std::vector<float>> out;
  if (options_.ao) out.push_back(ao_variances());
  for (std::size_t light = 0; light < layout_.lights.size(); ++light) {
    LightVariances of_light = light_variances(light);
    const double largest = of_light.largest > 0 ? of_light.largest : 1.0;
    const double factor = 1.0 / (largest * largest);
    for (float& variance : of_light.absolute) variance = static_cast<float>(variance * factor);
    out.push_back(std::move(of_light.absolute));
  }
  return out;
}

std::vector<double> FilmMoments::largest_values() const {
  std::vector<double> out(options_.ao ? 1 : 0, 1.0);
  for (std::size_t light = 0; light < layout_.lights.size(); ++light) {
    const LightPass pass = light_pass(light);
    out.push_back(largest_unoccluded(pass, [&](std::size_t p) { return variance_at(pass, p); }));
  }
  for (const LightGroup& group : layout_.groups) out.push_back(largest_unoccluded(group, out));
  return out;
}

// The largest of noisy means is too large, and so may be the sum of the largest of each light.
double FilmMoments::largest_unoccluded(const LightGroup& group,
                                       const std::vector<double>& largest) const {
  double bound = 0, found = 0;
  for (std::size_t i = 0; i < group.lights.size(); ++i)
    bound += group.luminances[i] * largest[group.lights[i] + (options_.ao ? 1 : 0)];
  for (std::uint32_t p = 0; p < layout_.pixels; ++p) {
    double value = 0;
    for (std::size_t i = 0; i < group.lights.size(); ++i) {
      const LightPass pass = light_pass(group.lights[i]);
      value += group.luminances[i] * pass.scale *
               luminance_sum(pass.planes.unoccluded(), pass.planes.channels, p);
    }
    found = std::max(found, mean(value, p));
  }
  return std::min(found, bound);
}

// Occlusion is 0 where samples missed.
std::vector<float> FilmMoments::ao_variances() const {
  const double scale = 1.0 / (double{layout_.unit_scale} * options_.ao_rays);
  const auto occlusion = [&](std::uint32_t p) {
    return mean(sum(0, p) - sum(layout_.ao, p) * scale, p);
  };
  return batch_variances(samples_, width_, [&](std::size_t p) { return moments(occlusion, 0, p); });
}

FilmMoments::LightPass FilmMoments::light_pass(std::size_t light) const {
  const LightPlaneRange& planes = layout_.lights[light];
  return {planes, 1.0 / (double{planes.scale} * options_.light_rays), layout_.light_squares(light)};
}

BatchMoments FilmMoments::light_moments(const LightPass& pass, std::size_t pixel) const {
  const auto irradiance = [&](std::uint32_t p) {
    return mean(luminance_sum(pass.planes.first, pass.planes.channels, p) * pass.scale, p);
  };
  return moments(irradiance, pass.squares, pixel);
}

float FilmMoments::variance_at(const LightPass& pass, std::size_t pixel) const {
  return batch_variance_at(pixel, samples_, width_,
                           [&](std::size_t p) { return light_moments(pass, p); });
}

FilmMoments::LightVariances FilmMoments::light_variances(std::size_t light) const {
  const LightPass pass = light_pass(light);
  std::vector<float> variances =
      batch_variances(samples_, width_, [&](std::size_t p) { return light_moments(pass, p); });
  const double largest = largest_unoccluded(pass, [&](std::size_t p) { return variances[p]; });
  return {std::move(variances), largest};
}

// The largest of noisy means is biased upwards. So each mean counts less its standard error,
// estimated from the occluded irradiance, but not less than the mean of its neighbours (experiment
// 503). For pilot pixels the largest mean is used, because pixels between them may be brighter.
// Standard errors are needed only where the mean is above what all pixels have without them.
template <class Variance>
double FilmMoments::largest_unoccluded(const LightPass& pass, const Variance& variance) const {
  const bool only_pilot = std::find(samples_.begin(), samples_.end(), 0u) != samples_.end();
  const auto unoccluded = [&](std::size_t p) -> std::array<float, 2> {
    const auto pixel = static_cast<std::uint32_t>(p);
    const auto hits = static_cast<float>(sum(0, pixel));
    if (samples_[p] == 0 || hits == 0) return {};
    return {static_cast<float>(
                luminance_sum(pass.planes.unoccluded(), pass.planes.channels, pixel) * pass.scale),
            hits};
  };
  const auto row_count = layout_.pixels / static_cast<std::uint32_t>(width_);
  std::vector<float> of_rows(row_count), means_of_rows(row_count);
  visit_neighbourhoods(
      layout_.pixels, width_, unoccluded,
      [&](std::size_t p, const std::array<float, 2>& own, const std::array<float, 2>& around) {
        if (own[1] == 0) return;
        const auto samples = static_cast<float>(samples_[p]);
        const float mean = own[0] / samples, by_others = around[0] / around[1] * own[1] / samples;
        const std::size_t row = p / static_cast<std::size_t>(width_);
        means_of_rows[row] = std::max(means_of_rows[row], mean);
        of_rows[row] = std::max(of_rows[row], only_pilot ? mean : std::min(mean, by_others));
      });
  const float without_errors = *std::max_element(of_rows.begin(), of_rows.end());
  tbb::parallel_for(0u, row_count, [&](std::uint32_t row) {
    if (only_pilot || means_of_rows[row] <= without_errors) return;
    for (std::size_t p = std::size_t{row} * width_; p < std::size_t{row + 1} * width_; ++p) {
      const auto samples = static_cast<float>(samples_[p]);
      const float mean = unoccluded(p)[0] / samples;
      if (!(mean > without_errors)) continue;
      const float error = std::sqrt(variance(p) * DAPPLE_SAMPLE_BATCH / samples);
      of_rows[row] = std::max(of_rows[row], mean - error);
    }
  });
  return *std::max_element(of_rows.begin(), of_rows.end());
}

}  // namespace dapple
