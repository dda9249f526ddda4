#include "bake/instance_bake.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "bake/samples/placed_areas.hpp"
#include "bake/two_sided.hpp"
#include "bake/vertex_bake.hpp"
#include "sampling/random_choice.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

/// Samples that are traced between two questions whether to stop.
constexpr std::size_t kSamplesAtOnce = 1u << 16;

/// Rays of a sample whose brighter side counts: from fewer it is too often not known which that is.
constexpr int kRaysForSides = 32;

/// The radical inverse in base 2: van der Corput's sequence.
double radical_inverse(std::uint32_t index) {
  double value = 0;
  for (double digit = 0.5; index > 0; index >>= 1, digit /= 2) value += digit * (index & 1);
  return value;
}

/// Points of a mesh, triangles by their area: a sequence whose beginnings are spread evenly over
/// the sum of areas. All instances of the mesh have the same ones, so that their values differ by
/// their surroundings alone. Strands have none.
class PointsOfMesh {
 public:
  PointsOfMesh(const Scene& scene, std::uint32_t index, const TwoSided& two_sided,
               const BakeOptions& options)
      : mesh_(scene.meshes[index]),
        normals_(options.normals),
        two_sided_(two_sided.triangles(mesh_)),
        sums_(mesh_.has_strands() ? 0 : mesh_.primitive_count()),
        shift_(hash_of(options.seed, index) * 0x1p-32) {
    double area = 0;
    for (std::size_t t = 0; t < sums_.size(); ++t)
      sums_[t] = area += has_area(mesh_, t) ? double{area_vector(mesh_, t).length()} : 0.0;
  }

  /// The next `count` points; none if the mesh has no area. `groups`: for as many vertices.
  std::vector<SurfaceSample> next(std::uint32_t count, const VertexGroups& groups) {
    std::vector<SurfaceSample> samples;
    if (sums_.empty() || !(sums_.back() > 0)) return samples;
    const SampledTriangles triangles{mesh_, groups, two_sided_, normals_};
    for (const std::uint32_t end = taken_ + count; taken_ < end; ++taken_) {
      const double share = radical_inverse(taken_) + shift_;
      const double at = (share < 1 ? share : share - 1) * sums_.back();
      const auto t = static_cast<std::size_t>(std::upper_bound(sums_.begin(), sums_.end(), at) -
                                              sums_.begin());
      samples.push_back(sample_triangle(triangles, t, of_triangle_[t]++));
    }
    return samples;
  }

 private:
  const Mesh& mesh_;
  Normals normals_;
  std::vector<bool> two_sided_;
  std::vector<double> sums_;  ///< areas of all triangles up to one
  double shift_;              ///< of the sequence, [0,1)
  std::uint32_t taken_ = 0;
  std::map<std::size_t, std::uint32_t> of_triangle_;  ///< points taken of a triangle
};

/// A flat list of samples of consecutive instances.
struct InstanceSlice {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement, instance;
  std::vector<float> weight;  ///< area of the surface there over that by which it was chosen
  Placements placements;
};

/// Sums over the samples of each instance.
class InstanceSums {
 public:
  InstanceSums(std::size_t instances, std::size_t lights)
      : of_instance_(instances), light_(lights, std::vector<V3f>(instances, V3f(0))) {}

  /// Of a two-sided sample the mean of both sides. Samples inside closed geometry do not count.
  void add(const InstanceSlice& slice, const TracedSamples& found) {
    largest_ = std::max(largest_, found.largest);
    for (std::size_t s = 0; s < slice.samples.size(); ++s) {
      if (found.is_inside(s))
        ++of_instance_[slice.instance[s]].inside;
      else
        add(slice, s, part_of(found, s, slice.samples[s].back ? 0.5f : 0.0f));
    }
  }

  /// Of a two-sided sample the brighter side. Each of two traces tells which side of the other one
  /// counts: the larger of two values would be too large by their noise.
  void add(const InstanceSlice& slice, const TracedSamples& one, const TracedSamples& other) {
    largest_ = std::max({largest_, one.largest, other.largest});
    for (std::size_t s = 0; s < slice.samples.size(); ++s) {
      if (one.is_inside(s) || other.is_inside(s)) {
        ++of_instance_[slice.instance[s]].inside;
        continue;
      }
      const auto back_of = [&](const TracedSamples& found) {
        const bool behind = found.back[s].scalar > found.front[s].scalar;
        return slice.samples[s].back && behind ? 1.0f : 0.0f;
      };
      Part value = part_of(one, s, back_of(other));
      const Part second = part_of(other, s, back_of(one));
      value.scalar = 0.5f * (value.scalar + second.scalar);
      for (std::size_t l = 0; l < light_.size(); ++l)
        value.light[l] = (value.light[l] + second.light[l]) * 0.5f;
      add(slice, s, value);
    }
  }

  /// Whether the instance has samples, inside closed geometry or not.
  [[nodiscard]] bool has_any(std::uint32_t instance) const {
    return of_instance_[instance].count + of_instance_[instance].inside > 0;
  }
  [[nodiscard]] std::uint32_t count(std::uint32_t instance) const {
    return of_instance_[instance].count;
  }
  /// 0 if all of the instance is inside closed geometry.
  [[nodiscard]] double mean(std::uint32_t instance) const {
    const Sums& of = of_instance_[instance];
    return of.count > 0 ? of.sum / of.weight : 0;
  }
  [[nodiscard]] V3f mean_light(std::size_t light, std::uint32_t instance) const {
    const Sums& of = of_instance_[instance];
    return of.count > 0 ? light_[light][instance] / static_cast<float>(of.weight) : V3f(0);
  }
  /// The squared standard error of a mean of independent samples, relative to the largest
  /// unoccluded value so far (of AO: 1). That samples are spread evenly makes it smaller.
  [[nodiscard]] double squared_error(std::uint32_t instance) const {
    const Sums& of = of_instance_[instance];
    if (of.count == 0 || !(largest_ > 0)) return 0;
    const double n = of.count, mean = of.sum / of.weight;
    if (of.count == 1) {  // no more than of values that are all 0 or the largest
      const double value = std::min(mean / double{largest_}, 1.0);
      return value * (1 - value);
    }
    const double deviations = of.squares - mean * (2 * of.products - mean * of.weight_squares);
    return std::max(deviations, 0.0) * n / ((n - 1) * of.weight * of.weight) /
           (double{largest_} * double{largest_});
  }

 private:
  struct Sums {
    double weight = 0, sum = 0;  ///< of weights, and of these times values
    /// Sums of squared weights, of these times values, and times squared values.
    double weight_squares = 0, products = 0, squares = 0;
    std::uint32_t count = 0, inside = 0;  ///< samples that count, and those that do not
  };
  /// The value of a sample.
  struct Part {
    float scalar = 0;
    std::vector<V3f> light;
  };

  /// `back`: how much the back counts, [0,1].
  [[nodiscard]] Part part_of(const TracedSamples& found, std::size_t sample, float back) const {
    Part part{(1 - back) * found.front[sample].scalar + back * found.back[sample].scalar, {}};
    for (std::size_t l = 0; l < light_.size(); ++l)
      part.light.push_back(found.front_light[sample * light_.size() + l] * (1 - back) +
                           found.back_light[sample * light_.size() + l] * back);
    return part;
  }
  void add(const InstanceSlice& slice, std::size_t sample, const Part& part) {
    const std::uint32_t instance = slice.instance[sample];
    Sums& of = of_instance_[instance];
    const double weight = double{slice.weight[sample]}, value = double{part.scalar};
    of.weight += weight;
    of.sum += weight * value;
    of.weight_squares += weight * weight;
    of.products += weight * weight * value;
    of.squares += weight * weight * value * value;
    ++of.count;
    for (std::size_t l = 0; l < light_.size(); ++l)
      light_[l][instance] += part.light[l] * slice.weight[sample];
  }

  std::vector<Sums> of_instance_;
  std::vector<std::vector<V3f>> light_;  ///< by light and instance
  float largest_ = 0;
};

/// Samples of all instances, in rounds.
class InstanceRounds {
 public:
  InstanceRounds(const Scene& scene, const BakeOptions& options, BakeTracing& tracing, bool lights)
      : scene_(scene),
        options_(options),
        tracing_(tracing),
        lights_(lights),
        sums_(scene.instances.size(), lights ? tracing.lights : 0) {
    const TwoSided two_sided(scene, options.sides);
    std::size_t most = 0;  // vertices of a mesh
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      points_.emplace_back(scene, m, two_sided, options);
      most = std::max(most, scene.meshes[m].positions.size());
    }
    one_group_ = one_group(most);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
      if (is_invertible(scene.instances[i].to_world) &&
          !scene.meshes[scene.instances[i].mesh].has_strands())
        unfinished_.push_back(i);
  }

  /// False: stopped.
  bool run() {
    const auto most = static_cast<std::uint32_t>(options_.rays / kRaysPerSample);
    if (!tracing_.progress.add(0)) return false;
    for (std::uint32_t taken = 0; taken < most && !unfinished_.empty();) {
      const std::uint32_t count = std::min(kInstanceRound, most - taken);
      if (options_.target_error > 0 && taken >= kExpectedRounds * kInstanceRound)
        tracing_.progress.expect(1.0 * count * static_cast<double>(unfinished_.size()));
      if (!trace_round(count)) return false;
      taken += count;
      drop_finished();
    }
    tracing_.progress.show();
    return true;
  }

  [[nodiscard]] const InstanceSums& sums() const { return sums_; }

  /// Instances with samples, and those that have too few for the target.
  [[nodiscard]] TargetStatistics counts() const {
    TargetStatistics counts;
    const double target = double{options_.target_error} * double{options_.target_error};
    for (std::uint32_t i = 0; i < scene_.instances.size() && target > 0; ++i) {
      if (sums_.count(i) == 0) continue;
      ++counts.values;
      if (sums_.squared_error(i) > target) ++counts.above;
    }
    return counts;
  }

 private:
  bool trace_round(std::uint32_t count) {
    std::map<std::uint32_t, std::vector<SurfaceSample>> of_mesh;
    InstanceSlice slice;
    for (const std::uint32_t i : unfinished_) {
      const std::uint32_t mesh = scene_.instances[i].mesh;
      const auto [found, is_new] = of_mesh.try_emplace(mesh);
      if (is_new) found->second = points_[mesh].next(count, one_group_);
      const PlacedAreas areas(scene_.instances[i].to_world);
      for (const SurfaceSample& sample : found->second) {
        const bool is_flat = sample.geometric == V3f(0, 0, 0);
        slice.weight.push_back(areas.scale_of(is_flat ? sample.normal : sample.geometric));
        slice.samples.push_back(sample);
        slice.placement.push_back(static_cast<std::uint32_t>(slice.placements.to_world.size()));
        slice.instance.push_back(i);
      }
      slice.placements.add(scene_.instances[i].to_world);
      if (slice.samples.size() < kSamplesAtOnce) continue;
      if (!trace(slice)) return false;
      slice = {};
    }
    return slice.samples.empty() || trace(slice);
  }

  bool trace(const InstanceSlice& slice) {
    const bool choose = options_.sides != BakeSides::mean &&
                        std::any_of(slice.samples.begin(), slice.samples.end(),
                                    [](const SurfaceSample& sample) { return sample.back; });
    const int rays = lights_ ? options_.light_rays : choose ? kRaysForSides : kRaysPerSample;
    const TracedSamples one = traced(slice, rays);
    if (choose)
      sums_.add(slice, one, traced(slice, rays));
    else
      sums_.add(slice, one);
    return tracing_.progress.add(slice.samples.size());
  }

  TracedSamples traced(const InstanceSlice& slice, int rays) {
    const TraceSamples& trace = lights_ ? tracing_.light.values : tracing_.ao.values;
    const TracedSamples found = trace(slice.samples, slice.placement, slice.placements, rays,
                                      hash_of(lights_ ? 0x55555555u : 0u, traces_++));
    for (const std::uint8_t inside : found.inside) tracing_.statistics.inside_samples += inside;
    tracing_.statistics.points += found.points;
    tracing_.statistics.rays += found.rays;
    return found;
  }

  /// Those with an error below the target, and those without an area.
  void drop_finished() {
    const double target = double{options_.target_error} * double{options_.target_error};
    std::erase_if(unfinished_, [&](std::uint32_t i) {
      return !sums_.has_any(i) || (target > 0 && sums_.squared_error(i) <= target);
    });
  }

  const Scene& scene_;
  const BakeOptions& options_;
  BakeTracing& tracing_;
  bool lights_;
  InstanceSums sums_;
  std::vector<PointsOfMesh> points_;  ///< by mesh
  VertexGroups one_group_;            ///< all vertices: samples have no weights for single ones
  std::vector<std::uint32_t> unfinished_;
  std::uint32_t traces_ = 0;
};

void add(TargetStatistics& sum, const TargetStatistics& counts) {
  sum.values += counts.values;
  sum.above += counts.above;
}

}  // namespace

std::optional<InstanceValues> bake_instances(const Scene& scene, const BakeOptions& options,
                                             BakeTracing& tracing) {
  const auto count = static_cast<std::uint32_t>(scene.instances.size());
  InstanceValues values{std::vector<float>(count, 1.0f),
                        std::vector(tracing.lights, std::vector<V3f>(count, V3f(0)))};
  InstanceRounds ao(scene, options, tracing, false);
  if (!ao.run()) return {};
  add(tracing.statistics.ao_target, ao.counts());
  for (std::uint32_t i = 0; i < count; ++i) {
    if (ao.sums().has_any(i)) {
      values.ao[i] = static_cast<float>(ao.sums().mean(i));
      ++tracing.statistics.sampled_values;
    }
    tracing.statistics.squared_errors += ao.sums().squared_error(i);
  }
  if (tracing.lights > 0) {
    InstanceRounds light(scene, options, tracing, true);
    if (!light.run()) return {};
    add(tracing.statistics.light_target, light.counts());
    for (std::uint32_t i = 0; i < count; ++i) {
      tracing.statistics.squared_light_errors += light.sums().squared_error(i);
      for (std::size_t l = 0; l < values.light.size() && light.sums().count(i) > 0; ++l)
        values.light[l][i] = light.sums().mean_light(l, i);
    }
  }
  tracing.statistics.instances = static_cast<std::size_t>(
      std::count_if(scene.instances.begin(), scene.instances.end(),
                    [](const Instance& instance) { return is_invertible(instance.to_world); }));
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.has_strands()) tracing.statistics.triangles += mesh.primitive_count();
  return values;
}

}  // namespace dapple
