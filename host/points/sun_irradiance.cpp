#include "points/sun_irradiance.hpp"

#include "points/point_sets.hpp"
#include "points/ray_slices.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {

std::vector<std::vector<double>> sun_parts(const SceneOfPoints& on, const SunRays& suns,
                                           std::span<const V3f> points,
                                           std::span<const V3f> normals,
                                           const PointOptions& options, std::size_t sets,
                                           std::uint32_t seed,
                                           const std::function<bool(double)>& step) {
  const auto of_set = static_cast<std::size_t>(options.rays / kPointSets);
  std::vector<std::vector<double>> parts(sets, std::vector<double>(points.size()));
  const auto make = [&](std::size_t i, std::span<Ray> rays) {
    suns.sample(points[i], normals[i], sets, hash_of(seed, static_cast<std::uint32_t>(i)), rays);
  };
  const auto add = [&](std::size_t i, std::size_t r, double transmittance) {
    parts[r % sets][i] += transmittance / static_cast<double>(of_set);
  };
  trace_slices(on, {points.size(), of_set * sets, options.estimator, options.footprint}, make, add,
               [&](std::size_t count) {
                 return step(static_cast<double>(count) / static_cast<double>(points.size()));
               });
  return parts;
}

}  // namespace dapple
