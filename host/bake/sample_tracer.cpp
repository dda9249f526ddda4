#include "bake/sample_tracer.hpp"

#include <tbb/parallel_for.h>

namespace dapple {
namespace {

/// Points in the world.
struct WorldPoints {
  explicit WorldPoints(std::size_t count) : positions(count), normals(count) {}
  std::vector<V3f> positions, normals;
};

V3f unit_normal(const V3f& normal, const M44f& inverse) {
  V3f out;
  inverse.transposed().multDirMatrix(normal, out);
  return out.normalized();
}

}  // namespace

void Placements::add(const M44f& matrix) {
  to_world.push_back(matrix);
  to_object.push_back(matrix.inverse());
}

TracedSamples SampleTracer::trace(std::span<const SurfaceSample> samples,
                                  std::span<const std::uint32_t> placement,
                                  const Placements& placements, int rays, std::uint32_t hash) {
  return {trace_side(samples, placement, placements, rays, hash, false),
          trace_side(samples, placement, placements, rays, hash_of(hash, 1), true)};
}

std::vector<SideValue> SampleTracer::trace_side(std::span<const SurfaceSample> samples,
                                                std::span<const std::uint32_t> placement,
                                                const Placements& placements, int rays,
                                                std::uint32_t hash, bool back) {
  std::vector<SideValue> values(samples.size());
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    if (back ? samples[i].back : samples[i].front) chosen.push_back(i);
  if (chosen.empty()) return values;
  WorldPoints points(chosen.size());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t k) {
    const SurfaceSample& sample = samples[chosen[k]];
    const std::size_t at = placement[chosen[k]];
    points.positions[k] = sample.position * placements.to_world[at];
    const V3f normal = unit_normal(sample.normal, placements.to_object[at]);
    points.normals[k] = back ? -normal : normal;
  });
  OcclusionOptions options;
  options.rays = rays;
  options.estimator = options_.estimator;
  options.footprint = options_.footprint;
  options.distance = options_.distance;
  options.falloff = options_.falloff;
  options.seed = hash_of(options_.seed, hash);
  const PointOcclusion traced = trace_(points.positions, points.normals, options, options_.bent);
  statistics_.points += chosen.size();
  statistics_.rays += chosen.size() * static_cast<std::uint64_t>(rays);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    SideValue& value = values[chosen[k]];
    value.ao = traced.ao[k];
    if (options_.bent)
      placements.to_object[placement[chosen[k]]].multDirMatrix(traced.bent[k], value.bent);
  }
  return values;
}

}  // namespace dapple
