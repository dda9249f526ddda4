#include "points/ring_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "points/point_ray.hpp"
#include "points/ray_slices.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array<std::array<double, 2>, 5> kLai2200{
    {{0, 13}, {16, 28}, {32, 43}, {47, 58}, {61, 74}}};

}  // namespace

std::vector<ZenithRing> zenith_rings(int count) {
  std::vector<ZenithRing> rings;
  for (int i = 0; i < count; ++i) {
    const auto [inner, outer] =
        count == 5 ? kLai2200[static_cast<std::size_t>(i)]
                   : std::array<double, 2>{90.0 * i / count, 90.0 * (i + 1) / count};
    rings.push_back({std::cos(inner * kDegree), std::cos(outer * kDegree)});
  }
  return rings;
}

void fill_ring_rays(const V3f& point, const V3f& normal, const ZenithRing& ring,
                    std::uint32_t random, std::span<Ray> rays) {
  using std::numbers::pi;
  const double golden = pi * (3 - std::sqrt(5.0));
  const auto count = static_cast<double>(rays.size());
  const double turn = 2 * pi * (random & 0xffffu) / 65536.0, shift = (random >> 16) / 65536.0;
  const double solid_angle = 2 * pi * (ring.cos_inner - ring.cos_outer) / count;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    const double y =
        ring.cos_inner + (ring.cos_outer - ring.cos_inner) * std::min(1.0, (i + shift) / count);
    const double radius = std::sqrt(std::max(0.0, 1 - y * y)), angle = turn + golden * i;
    rays[i] = point_ray(point, normal,
                        V3f(static_cast<float>(radius * std::cos(angle)), static_cast<float>(y),
                            static_cast<float>(radius * std::sin(angle))),
                        static_cast<float>(solid_angle), hash_of(random, i));
  }
}

std::vector<double> gap_fractions(const SceneOfPoints& on, const std::vector<ZenithRing>& rings,
                                  std::span<const V3f> points, std::span<const V3f> normals,
                                  const OcclusionOptions& of_ring,
                                  const std::function<bool(double)>& step) {
  const auto each = static_cast<std::size_t>(std::max(1, of_ring.rays));
  std::vector<double> means(points.size() * rings.size());
  const auto make = [&](std::size_t i, std::span<Ray> rays) {
    const std::uint32_t of_point = hash_of(of_ring.seed, static_cast<std::uint32_t>(i));
    for (std::size_t k = 0; k < rings.size(); ++k)
      fill_ring_rays(points[i], normals[i], rings[k],
                     hash_of(of_point, static_cast<std::uint32_t>(k)),
                     rays.subspan(k * each, each));
  };
  const auto add = [&](std::size_t i, std::size_t r, double transmittance) {
    means[i * rings.size() + r / each] += transmittance / static_cast<double>(each);
  };
  trace_slices(on, {points.size(), rings.size() * each, of_ring.estimator, of_ring.footprint}, make,
               add, [&](std::size_t count) {
                 return step(static_cast<double>(count) / static_cast<double>(points.size()));
               });
  return means;
}

}  // namespace dapple
