#include "bake/light_bake.hpp"

#include <algorithm>

#include "dapple/render.hpp"

namespace dapple {
namespace {

/// Triangles whose samples are traced between two questions whether to stop.
constexpr std::size_t kTrianglesAtOnce = 1u << 14;

/// Sums over the samples around each vertex group, of one side.
struct SideSums {
  SideSums(std::size_t groups, std::size_t lights)
      : weight(groups), irradiance(lights, std::vector<V3f>(groups, V3f(0, 0, 0))) {}
  std::vector<float> weight;
  std::vector<std::vector<V3f>> irradiance;  ///< by light and group

  [[nodiscard]] V3f mean(std::size_t light, std::size_t group) const {
    return weight[group] > 0 ? irradiance[light][group] / weight[group] : V3f(0, 0, 0);
  }
  /// Of all lights together.
  [[nodiscard]] float brightness(std::size_t group) const {
    float sum = 0;
    for (std::size_t l = 0; l < irradiance.size(); ++l) {
      const V3f value = mean(l, group);
      sum += value.x + value.y + value.z;
    }
    return sum;
  }
};

class LightBake {
 public:
  LightBake(const Placements& placements, const BakeOptions& options,
            const OccluderScene& occluders, std::uint32_t hash)
      : placements_(placements), options_(options), occluders_(occluders), hash_(hash) {}

  /// Traces one side of the samples, and adds what reaches them.
  void add(const std::vector<SurfaceSample>& samples, bool back, SideSums& sums) {
    std::vector<V3f> points, normals;
    std::vector<const SurfaceSample*> chosen;
    for (const SurfaceSample& sample : samples) {
      if (back && !sample.back) continue;
      const auto i = static_cast<std::uint32_t>(chosen.size());
      const std::size_t at = hash_of(hash_of(hash_, batch_), i) % placements_.to_world.size();
      V3f normal;
      placements_.to_object[at].transposed().multDirMatrix(sample.normal, normal);
      points.push_back(sample.position * placements_.to_world[at]);
      normals.push_back(back ? -normal.normalized() : normal.normalized());
      chosen.push_back(&sample);
    }
    IrradianceOptions options;
    options.rays = options_.light_rays;
    options.estimator = options_.estimator;
    options.footprint = options_.footprint;
    options.seed = hash_of(options_.seed, hash_of(hash_, batch_++));
    const auto found = irradiance(occluders_.device, occluders_.uploaded, occluders_.lights, points,
                                  normals, options);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t group = chosen[i]->place[k];
        sums.weight[group] += chosen[i]->weight[k];
        for (std::size_t l = 0; l < found.size(); ++l)
          sums.irradiance[l][group] += found[l].irradiance[i] * chosen[i]->weight[k];
      }
    }
  }

 private:
  const Placements& placements_;
  const BakeOptions& options_;
  const OccluderScene& occluders_;
  std::uint32_t hash_, batch_ = 0;
};

V3f value_of(const SideSums& front, const SideSums& back, BakeSides sides, std::size_t light,
             std::size_t group) {
  if (back.weight[group] <= 0) return front.mean(light, group);
  if (sides == BakeSides::mean) return (front.mean(light, group) + back.mean(light, group)) * 0.5f;
  const bool behind = back.brightness(group) > front.brightness(group);
  return (behind ? back : front).mean(light, group);
}

}  // namespace

std::optional<std::vector<std::vector<V3f>>> bake_lights(
    const Mesh& mesh, const std::vector<bool>& two_sided, std::uint32_t index,
    const Placements& placements, const BakeOptions& options, const OccluderScene& occluders,
    BakeProgress& progress) {
  const bool any = std::find(two_sided.begin(), two_sided.end(), true) != two_sided.end();
  const VertexGroups groups = group_vertices(mesh, any);
  const std::size_t lights = occluders.lights.size();
  SideSums front(groups.count, lights), back(groups.count, lights);
  const std::uint32_t hash = hash_of(options.seed, index);
  LightBake bake(placements, options, occluders, hash);
  std::vector<SurfaceSample> samples;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::uint32_t shift = hash_of(hash, static_cast<std::uint32_t>(t)) & 0xffffu;
    for (std::uint32_t i = 0; i < kLightSamples && has_area(mesh, t); ++i)
      samples.push_back(sample_triangle(mesh, t, groups, two_sided[t], i ^ shift));
    if ((t + 1) % kTrianglesAtOnce != 0 && t + 1 != mesh.primitive_count()) continue;
    bake.add(samples, false, front);
    bake.add(samples, true, back);
    if (!progress.add(samples.size())) return {};
    samples.clear();
  }
  std::vector<std::vector<V3f>> values(lights);
  for (std::size_t l = 0; l < lights; ++l)
    for (const std::uint32_t group : groups.of_vertex)
      values[l].push_back(value_of(front, back, options.sides, l, group));
  return values;
}

}  // namespace dapple
