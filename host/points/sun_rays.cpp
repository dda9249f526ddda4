#include "points/sun_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "points/point_ray.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kCurveSteps = 4096;  ///< along each axis

double irradiance_on(const V3f& normal, const SunDirection& sun) {
  return double{sun.irradiance} * std::max(0.0, double{normal.dot(sun.direction)});
}

/// Position on the Hilbert curve through a square of kCurveSteps steps a side.
std::uint32_t along_curve(std::uint32_t x, std::uint32_t y) {
  std::uint32_t position = 0;
  for (std::uint32_t half = kCurveSteps / 2; half > 0; half /= 2) {
    const bool right = x & half, upper = y & half;
    position += half * half * (right ? (upper ? 2u : 3u) : (upper ? 1u : 0u));
    if (upper) continue;
    if (right) {
      x = kCurveSteps - 1 - x;
      y = kCurveSteps - 1 - y;
    }
    std::swap(x, y);
  }
  return position;
}

/// The same through all directions, seen from -Y: Lambert's azimuthal projection, which keeps
/// areas.
std::uint32_t along_curve(const V3f& direction) {
  const double scale = 1 / std::sqrt(2 * std::max(1e-6, 1 + double{direction.y}));
  const auto step = [&](float x) {
    const double at = (double{x} * scale + 1) / 2 * kCurveSteps;
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, kCurveSteps - 1.0));
  };
  return along_curve(step(direction.x), step(direction.z));
}

}  // namespace

V3f direction_to_disk(const V3f& direction, double u, double v) {
  using Imath::V3d;
  const double down = u * double{kSunSolidAngle} / (2 * std::numbers::pi);  // 1 - cosine
  const double radius = std::sqrt(down * (2 - down)), angle = 2 * std::numbers::pi * v;
  const V3d middle = V3d(direction).normalized();
  const V3d side =
      middle.cross(std::fabs(middle.x) < 0.5 ? V3d(1, 0, 0) : V3d(0, 1, 0)).normalized();
  return V3f(middle * (1 - down) + side * (radius * std::cos(angle)) +
             middle.cross(side) * (radius * std::sin(angle)));
}

SunRays::SunRays(std::span<const SunDirection> suns)
    : suns_(suns.begin(), suns.end()), irradiance_before_{0}, vectors_before_{Imath::V3d(0, 0, 0)} {
  std::stable_sort(suns_.begin(), suns_.end(), [](const SunDirection& a, const SunDirection& b) {
    return along_curve(a.direction) < along_curve(b.direction);
  });
  for (const SunDirection& sun : suns_) {
    const double irradiance{sun.irradiance};
    irradiance_before_.push_back(irradiance_before_.back() + irradiance);
    vectors_before_.push_back(vectors_before_.back() + Imath::V3d(sun.direction) * irradiance);
  }
}

double SunRays::unoccluded(const V3f& normal) const {
  double sum = 0;
  for (const SunDirection& sun : suns_) sum += irradiance_on(normal, sun);
  return sum;
}

// Directions that fill a cap of half angle a have a mean of length (1 + cos a) / 2 (Mardia and
// Jupp, "Directional Statistics", 2000), and the cap has the solid angle 2 pi (1 - cos a).
float SunRays::solid_angle(std::size_t first, std::size_t last) const {
  const double all = irradiance_before_[last + 1] - irradiance_before_[first];
  if (first == last || !(all > 0)) return kSunSolidAngle;
  const double length = (vectors_before_[last + 1] - vectors_before_[first]).length() / all;
  const double cap = 4 * std::numbers::pi * std::clamp(1 - length, 0.0, 0.5);
  return std::max(kSunSolidAngle, static_cast<float>(cap));
}

std::vector<double> SunRays::sums_of_irradiance(const V3f& normal) const {
  std::vector<double> sums(suns_.size() + 1);
  for (std::size_t s = 0; s < suns_.size(); ++s)
    sums[s + 1] = sums[s] + irradiance_on(normal, suns_[s]);
  return sums;
}

void SunRays::sample(const V3f& point, const V3f& normal, std::size_t sets, std::uint32_t random,
                     std::span<Ray> rays) const {
  const std::vector<double> sums = sums_of_irradiance(normal);
  if (!(sums.back() > 0)) {
    std::fill(rays.begin(), rays.end(), point_ray(point, normal, normal, kSunSolidAngle, 0));
    for (Ray& ray : rays) ray.t_max = 0;
    return;
  }
  const double step = sums.back() / static_cast<double>(rays.size());
  std::size_t sun = 0;
  const double shift_u = (random & 0xffffu) / 65536.0, shift_v = (random >> 16) / 65536.0;
  // A stratum of a set is divided into as many parts as there are sets; each takes another one.
  for (std::size_t first_ray = 0; first_ray < rays.size(); first_ray += sets) {
    const std::size_t first_sun = sun;
    const std::uint32_t turn = hash_of(random, static_cast<std::uint32_t>(first_ray));
    for (std::size_t part = 0; part < sets; ++part) {
      const std::uint32_t bits = hash_of(turn, static_cast<std::uint32_t>(part));
      const double at = step * (static_cast<double>(first_ray + part) + bits / 4294967296.0);
      while (sun + 1 < suns_.size() && sums[sun + 1] <= at) ++sun;
      const std::size_t set = (part + turn) % sets;
      Ray& ray = rays[first_ray + set];
      // By parts of a turn and golden sections: together they fill the disk evenly, too.
      const auto [u, v] =
          spread_pair(first_ray / sets, shift_u + static_cast<double>(set) * 0.6180339887498949,
                      shift_v + static_cast<double>(set) / static_cast<double>(sets));
      ray = point_ray(point, normal, direction_to_disk(suns_[sun].direction, u, v), 0,
                      hash_of(bits, turn));
    }
    const double end = step * static_cast<double>(first_ray + sets);
    while (sun + 1 < suns_.size() && sums[sun + 1] < end) ++sun;
    const float spread = solid_angle(first_sun, sun);
    for (std::size_t set = 0; set < sets; ++set) rays[first_ray + set].solid_angle = spread;
  }
}

}  // namespace dapple
