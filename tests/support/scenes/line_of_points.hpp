// Occlusion at close points along a line, all with the same ray directions. So the noise is the
// same at every point, and only the geometry and the set of covered nodes change from one to the
// next. In: a scene and an estimator; out: transmittances, and how much their means change a step.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "dapple/render.hpp"

namespace dapple::popping {

/// Strata of the unit square; each gives one ray direction.
struct Strata {
  int columns, rows;
  [[nodiscard]] int count() const { return columns * rows; }
};

/// A hash of 32 bits (a finalizer): mixes the bits of an index.
inline std::uint32_t mixed(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// A pseudo-random point in stratum `index`, in [0,1)^2.
inline V2f in_stratum(const Strata& strata, int index) {
  const auto bits = static_cast<std::uint32_t>(index);
  const auto unit = [](std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; };
  const V2f corner(static_cast<float>(index % strata.columns),
                   static_cast<float>(index / strata.columns));
  const V2f within(unit(mixed(2 * bits)), unit(mixed(2 * bits + 1)));
  return {(corner.x + within.x) / static_cast<float>(strata.columns),
          (corner.y + within.y) / static_cast<float>(strata.rows)};
}

/// A ray whose origin is not set. Its footprint is that of one of `shared` rays with this `pdf`.
inline Ray direction_ray(float height, float turn, float pdf, int shared, int index) {
  constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;
  const float across = std::sqrt(std::max(0.0f, 1 - height * height));
  Ray ray{};
  ray.direction[0] = across * std::cos(kTwoPi * turn);
  ray.direction[1] = height;
  ray.direction[2] = across * std::sin(kTwoPi * turn);
  ray.t_max = std::numeric_limits<float>::infinity();
  ray.solid_angle = std::min(kTwoPi, 1 / (static_cast<float>(shared) * pdf));
  ray.key = mixed(static_cast<std::uint32_t>(index) ^ 0x5bd1e995u);
  return ray;
}

/// Cosine-weighted directions about +Y; the pdf is cos / pi. Footprints as of `shared` rays a
/// point.
inline std::vector<Ray> hemisphere_rays(const Strata& strata, int shared) {
  std::vector<Ray> rays;
  for (int i = 0; i < strata.count(); ++i) {
    const V2f u = in_stratum(strata, i);
    const float cosine = std::sqrt(std::max(1e-8f, 1 - u.y));
    rays.push_back(direction_ray(cosine, u.x, cosine / std::numbers::pi_v<float>, shared, i));
  }
  return rays;
}

/// Directions uniform over the sphere; the pdf is 1 / (4 pi).
inline std::vector<Ray> sphere_rays(const Strata& strata, int shared) {
  std::vector<Ray> rays;
  for (int i = 0; i < strata.count(); ++i) {
    const V2f u = in_stratum(strata, i);
    rays.push_back(direction_ray(1 - 2 * u.y, u.x, 0.25f / std::numbers::pi_v<float>, shared, i));
  }
  return rays;
}

/// The middle `count` of `whole` equally spaced points on a line from side to side of the box. It
/// crosses a tree's crown at two thirds of the height, and is slightly tilted to favour no axis.
inline std::vector<V3f> line_through(const Box3f& box, int count, int whole) {
  const V3f size = box.size();
  const V3f from = box.min + size * V3f(0.02f, 0.62f, 0.42f);
  const V3f to = box.min + size * V3f(0.98f, 0.72f, 0.58f);
  std::vector<V3f> points;
  for (int i = 0; i < count; ++i) {
    const float share = (static_cast<float>(i + (whole - count) / 2) + 0.5f);
    points.push_back(from + (to - from) * (share / static_cast<float>(whole)));
  }
  return points;
}

/// Transmittances of `rays` from each point: all rays of the first point, then of the second, ...
inline std::vector<float> transmittances(const Device& device, const DeviceScene& scene,
                                         std::span<const V3f> points, std::span<const Ray> rays,
                                         Estimator estimator, float footprint) {
  constexpr std::size_t kPointsAtOnce = 64;
  std::vector<float> values;
  std::vector<Ray> placed;
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsAtOnce) {
    placed.clear();
    for (std::size_t p = begin; p < std::min(begin + kPointsAtOnce, points.size()); ++p) {
      for (Ray ray : rays) {
        for (int axis = 0; axis < 3; ++axis) ray.origin[axis] = points[p][axis];
        placed.push_back(ray);
      }
    }
    for (const Occlusion& found : trace(device, scene, placed, estimator, footprint))
      values.push_back(found.transmittance);
  }
  return values;
}

/// Change of the mean transmittance from one point to the next, exact and prefiltered.
struct Step {
  double exact = 0, prefiltered = 0;
  double error = 0;  ///< standard error of `prefiltered` - `exact`, from the rays' spread
  /// By how much the prefiltered step is larger than the exact one, whatever their signs.
  [[nodiscard]] double excess() const { return std::fabs(prefiltered) - std::fabs(exact); }
};

inline std::vector<Step> steps(const std::vector<float>& exact,
                               const std::vector<float>& prefiltered, std::size_t rays) {
  const auto n = static_cast<double>(rays);
  std::vector<Step> found;
  for (std::size_t at = rays; at < exact.size(); at += rays) {
    Step step;
    double squares = 0;
    for (std::size_t i = at; i < at + rays; ++i) {
      const double e = double{exact[i]} - exact[i - rays];
      const double p = double{prefiltered[i]} - prefiltered[i - rays];
      step.exact += e / n;
      step.prefiltered += p / n;
      squares += (p - e) * (p - e);
    }
    const double mean = step.prefiltered - step.exact;
    step.error = std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1));
    found.push_back(step);
  }
  return found;
}

/// The largest of each value; they may come from different steps.
struct LargestSteps {
  double exact = 0, prefiltered = 0, excess = 0, error = 0;
};

inline LargestSteps largest(const std::vector<Step>& steps) {
  LargestSteps max;
  for (const Step& step : steps) {
    max.exact = std::max(max.exact, std::fabs(step.exact));
    max.prefiltered = std::max(max.prefiltered, std::fabs(step.prefiltered));
    max.excess = std::max(max.excess, step.excess());
    max.error = std::max(max.error, step.error);
  }
  return max;
}

}  // namespace dapple::popping
