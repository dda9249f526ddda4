#include "bake/samples/sample_tracer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

V3f unit_normal(const V3f& normal, const M44f& inverse) {
  V3f out;
  inverse.transposed().multDirMatrix(normal, out);
  return out.normalized();
}

std::vector<SideValue> trace_side(const TracePoints& trace, const BakeOptions& bake,
                                  std::span<const std::uint32_t> placement,
                                  const Placements& placements, const WorldPoints& points,
                                  const OcclusionOptions& options) {
  std::vector<SideValue> values(placement.size());
  if (points.sample.empty()) return values;
  const PointOcclusion traced = trace(points.query(), options, bake.bent);
  for (std::size_t k = 0; k < points.sample.size(); ++k) {
    const std::uint32_t i = points.sample[k];
    values[i].scalar = traced.ao[k];
    if (!bake.bent) continue;
    placements.to_object[placement[i]].multDirMatrix(traced.bent[k], values[i].bent);
    values[i].bent = values[i].bent.normalized() * traced.bent[k].length();  // scales do not count
  }
  return values;
}

}  // namespace

void Placements::add(const M44f& matrix) {
  to_world.push_back(matrix);
  to_object.push_back(matrix.inverse());
}

WorldPoints::WorldPoints(std::span<const SurfaceSample> samples,
                         std::span<const std::uint32_t> placement, const Placements& placements,
                         bool back) {
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    if (back ? samples[i].back : samples[i].front) sample.push_back(i);
  positions_.resize(sample.size());
  normals_.resize(sample.size());
  const bool is_smooth = std::any_of(samples.begin(), samples.end(), [](const SurfaceSample& at) {
    return at.geometric.length2() > 0;
  });
  has_planes_ = std::all_of(samples.begin(), samples.end(),
                            [](const SurfaceSample& at) { return at.is_on_plane; });
  geometric_.resize(is_smooth ? sample.size() : 0, V3f(0, 0, 0));
  shifts_ = geometric_;
  reaches_.resize(sample.size());
  tbb::parallel_for(std::size_t{0}, sample.size(), [&](std::size_t k) {
    const SurfaceSample& at = samples[sample[k]];
    const std::size_t place = placement[sample[k]];
    const M44f &to_world = placements.to_world[place], &to_object = placements.to_object[place];
    positions_[k] = at.position * to_world;
    reaches_[k] = reach_in_world(at.reach, to_world);
    const V3f normal = unit_normal(at.normal, to_object);
    normals_[k] = back ? -normal : normal;
    if (!(at.geometric.length2() > 0)) return;
    const V3f geometric = unit_normal(at.geometric, to_object);
    geometric_[k] = back ? -geometric : geometric;
    to_world.multDirMatrix(back ? at.back_shift : at.shift, shifts_[k]);
  });
}

TraceSamples ao_tracer(TracePoints trace, const BakeOptions& bake) {
  return [trace = std::move(trace), &bake](
             std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
             const Placements& placements, int rays, std::uint32_t hash) {
    OcclusionOptions options;
    options.rays = rays;
    options.estimator = bake.estimator;
    options.footprint = bake.footprint;
    options.distance = bake.distance;
    options.falloff = bake.falloff;
    TracedSamples traced;
    for (const bool back : {false, true}) {
      options.seed = hash_of(bake.seed, back ? hash_of(hash, 1) : hash);
      const WorldPoints points(samples, placement, placements, back);
      (back ? traced.back : traced.front) =
          trace_side(trace, bake, placement, placements, points, options);
      traced.points += points.sample.size();
      traced.rays += points.sample.size() * static_cast<std::uint64_t>(rays);
    }
    return traced;
  };
}

}  // namespace dapple
