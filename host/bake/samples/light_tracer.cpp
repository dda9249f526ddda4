#include "bake/samples/light_tracer.hpp"

#include <algorithm>

#include "render/queries/point_irradiance.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

float brightness(const V3f& rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

/// Where the values of one side go.
struct SideOut {
  std::vector<SideValue>& total;
  std::vector<V3f>& by_light;
  float& largest;
};

void store(const WorldPoints& points, const std::vector<PointIrradiance>& found,
           const SideOut& out) {
  for (std::size_t k = 0; k < points.sample.size(); ++k) {
    const std::size_t i = points.sample[k];
    float unoccluded = 0;
    for (std::size_t l = 0; l < found.size(); ++l) {
      const V3f& value = found[l].irradiance[k];
      out.by_light[i * found.size() + l] = value;
      out.total[i].scalar += brightness(value);
      unoccluded += brightness(found[l].unoccluded[k]);
    }
    out.largest = std::max(out.largest, unoccluded);
  }
}

}  // namespace

TraceSamples light_tracer(const BakeOptions& bake, const OccluderScene& occluders) {
  return [&bake, &occluders](std::span<const SurfaceSample> samples,
                             std::span<const std::uint32_t> placement, const Placements& placements,
                             int rays, std::uint32_t hash) {
    const std::size_t lights = occluders.lights.size();
    IrradianceOptions options;
    options.rays = rays;
    options.estimator = bake.estimator;
    options.footprint = bake.footprint;
    TracedSamples traced;
    traced.largest = 0;
    for (const bool back : {false, true}) {
      std::vector<SideValue>& total = back ? traced.back : traced.front;
      std::vector<V3f>& by_light = back ? traced.back_light : traced.front_light;
      total.resize(samples.size());
      by_light.resize(samples.size() * lights, V3f(0, 0, 0));
      options.seed = hash_of(bake.seed, back ? hash_of(hash, 1) : hash);
      const WorldPoints points(samples, placement, placements, back);
      store(points,
            point_irradiance(occluders.device, occluders.uploaded, occluders.lights, points.query(),
                             options),
            {total, by_light, traced.largest});
      traced.points += points.sample.size();
      traced.rays += points.sample.size() * lights * static_cast<std::uint64_t>(rays);
    }
    return traced;
  };
}

}  // namespace dapple
