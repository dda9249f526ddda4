// measure_points(): a scene and points in, columns out. Each quantity is measured in independent
// sets of rays, whose differences give its standard error.
#include <Imath/ImathVec.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "film/light_layers.hpp"
#include "points/periodic.hpp"
#include "points/ring_rays.hpp"
#include "points/set_sums.hpp"
#include "render/point_occlusion.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

/// Independent sets of rays.
constexpr int kSets = 8;

/// Rays of suns or rings that are traced at once.
constexpr std::size_t kRaysAtOnce = 1u << 20;

/// Values of points, each from one set, that are also found exactly to learn the bias.
constexpr std::size_t kBiasSamples = 1024;

constexpr float kSunSolidAngle = 6.8e-5f;

using Imath::V3d;

/// Of the lights of a layer, at point i.
V3d sum_of(const std::vector<PointIrradiance>& found, const LightLayer& layer,
           std::vector<V3f> PointIrradiance::*which, std::size_t i) {
  V3d sum(0, 0, 0);
  for (const std::size_t light : layer.lights) sum += V3d((found[light].*which)[i]);
  return sum;
}

/// The scene on the device, as its points see it.
struct SceneOfPoints {
  SceneOfPoints(Scene given, const PointOptions& options)
      : device(options.device, options.kernel_dir), scene(std::move(given)) {
    for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
    finalize_domes(scene);
    if (options.period_x > 0) repeat(scene, options.period_x, options.period_z);
    if (options.ground) add_ground(scene);
    merge_single_instances(scene);
    bvh = build_bvh(scene, options.cache);
    uploaded = upload(device, scene, bvh);
  }

  Device device;
  Scene scene;
  SceneBvh bvh;
  DeviceScene uploaded;
};

class Measurement {
 public:
  Measurement(const SceneOfPoints& on, std::span<const V3f> points, std::span<const V3f> normals,
              const PointOptions& options, const RenderControl& control, PointResult& result)
      : on_(on),
        points_(points),
        normals_(normals),
        options_(options),
        control_(control),
        result_(result) {
    if (options.ao || options.bent) steps_ += kSets;
    if (options.sky_view_factor) steps_ += kSets;
    if (options.rings > 0) steps_ += kSets;
    if (has_lights()) steps_ += kSets;
    if (!options.suns.empty()) steps_ += 1;
    if (options.estimator == Estimator::prefiltered && options.footprint > 0) choose_sample();
  }

  void run() {
    if (options_.ao || options_.bent) measure_ao();
    if (options_.sky_view_factor) measure_sky_view_factor();
    if (options_.rings > 0) measure_rings();
    if (has_lights()) measure_lights();
    if (!options_.suns.empty()) measure_suns();
  }

 private:
  [[nodiscard]] bool has_lights() const { return options_.lights && !on_.scene.lights.empty(); }

  /// False: stopped.
  bool step(double part = 1) {
    done_ += part;
    if (control_.progress) control_.progress(std::min(1.0, done_ / steps_));
    result_.interrupted = result_.interrupted || (control_.stop && control_.stop());
    return !result_.interrupted;
  }

  [[nodiscard]] OcclusionOptions occlusion_options(int set) const {
    OcclusionOptions options;
    options.rays = options_.rays / kSets;
    options.estimator = options_.estimator;
    options.footprint = options_.footprint;
    options.seed = options_.seed * kSets + static_cast<std::uint32_t>(set);
    return options;
  }

  void choose_sample() {
    if (points_.empty()) return;
    const std::size_t step = (points_.size() + kBiasSamples - 1) / kBiasSamples;
    for (std::size_t i = 0; i < points_.size(); i += step) {
      sample_points_.push_back(points_[i]);
      sample_normals_.push_back(normals_[i]);
    }
    const std::size_t sets = (kBiasSamples + sample_points_.size() - 1) / sample_points_.size();
    sample_sets_ = static_cast<int>(std::min<std::size_t>(kSets, sets));
  }

  /// The bias of quantities in [0,1]. `values` finds them at the sample: a list for each.
  template <class Values>
  std::vector<BiasCorrection> bias_of(const std::vector<std::string>& names, Values values) {
    using Lists = std::vector<std::vector<double>>;
    Lists exact(names.size()), prefiltered(names.size());
    for (int set = 0; set < sample_sets_; ++set) {
      for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
        OcclusionOptions options = occlusion_options(set);
        options.estimator = estimator;
        const Lists found = values(options);
        Lists& all = estimator == Estimator::exact ? exact : prefiltered;
        for (std::size_t k = 0; k < names.size(); ++k)
          all[k].insert(all[k].end(), found[k].begin(), found[k].end());
      }
    }
    std::vector<BiasCorrection> corrections;
    for (std::size_t k = 0; k < names.size(); ++k) {
      corrections.emplace_back(exact[k], prefiltered[k]);
      const std::string note = corrections.back().note(names[k]);
      if (!note.empty()) result_.notes.push_back(note);
    }
    return corrections;
  }

  BiasCorrection occlusion_bias(const std::string& name, std::span<const V3f> normals,
                                float distance) {
    return bias_of({name}, [&](OcclusionOptions options) {
      options.distance = distance;
      const auto found = occlusion(on_.device, on_.uploaded, sample_points_, normals, options);
      return std::vector<std::vector<double>>{{found.begin(), found.end()}};
    })[0];
  }

  std::vector<BiasCorrection> light_bias(const std::vector<LightLayer>& layers) {
    std::vector<std::string> names;
    for (const LightLayer& layer : layers) names.push_back(layer.name);
    return bias_of(names, [&](const OcclusionOptions& of) {
      std::vector<std::vector<double>> parts(layers.size());
      const auto found =
          irradiance(on_.device, on_.uploaded, on_.scene.lights, sample_points_, sample_normals_,
                     {of.rays, of.estimator, of.footprint, of.seed});
      const V3d one(1, 1, 1);
      for (std::size_t l = 0; l < layers.size(); ++l)
        for (std::size_t i = 0; i < sample_points_.size(); ++i) {
          const double all = sum_of(found, layers[l], &PointIrradiance::unoccluded, i).dot(one);
          if (all > 0)
            parts[l].push_back(sum_of(found, layers[l], &PointIrradiance::irradiance, i).dot(one) /
                               all);
        }
      return parts;
    });
  }

  void measure_ao() {
    SetSums sums(points_.size());
    std::vector<V3f> bent(points_.size(), V3f(0, 0, 0));
    for (int set = 0; set < kSets; ++set) {
      OcclusionOptions options = occlusion_options(set);
      options.distance = options_.distance;
      const PointOcclusion found =
          point_occlusion(on_.device, on_.uploaded, {points_, normals_}, options, options_.bent);
      sums.add([&](std::size_t i) { return double{found.ao[i]}; });
      for (std::size_t i = 0; i < found.bent.size(); ++i) bent[i] += found.bent[i];
      if (!step()) return;
    }
    if (options_.ao)
      sums.store("ao", occlusion_bias("ao", sample_normals_, options_.distance), result_.columns);
    for (int axis = 0; axis < 3 && options_.bent; ++axis) {
      PointColumn column{std::string("bent_") + "xyz" [axis], {}};
      for (const V3f& b : bent) column.values.push_back(b.normalized()[axis]);
      result_.columns.push_back(std::move(column));
    }
  }

  void measure_sky_view_factor() {
    const std::vector<V3f> up(points_.size(), V3f(0, 1, 0));
    SetSums sums(points_.size());
    for (int set = 0; set < kSets; ++set) {
      const std::vector<float> found =
          occlusion(on_.device, on_.uploaded, points_, up, occlusion_options(set));
      sums.add([&](std::size_t i) { return double{found[i]}; });
      if (!step()) return;
    }
    const std::vector<V3f> sample_up(sample_points_.size(), V3f(0, 1, 0));
    sums.store("sky_view_factor", occlusion_bias("sky_view_factor", sample_up, 0), result_.columns);
  }

  /// Calls add(point, ray of the point, transmittance) for rays that make(point, rays) appends.
  template <class Make, class Add>
  bool trace_rays(std::size_t rays_per_point, double part, Make make, Add add) {
    const std::size_t slice = std::max<std::size_t>(1, kRaysAtOnce / rays_per_point);
    for (std::size_t begin = 0; begin < points_.size(); begin += slice) {
      const std::size_t end = std::min(points_.size(), begin + slice);
      std::vector<Ray> rays;
      rays.reserve((end - begin) * rays_per_point);
      for (std::size_t i = begin; i < end; ++i) make(i, rays);
      const std::vector<Occlusion> found = trace(on_.device, on_.uploaded, rays, options_.estimator,
                                                 options_.footprint, rays_per_point);
      for (std::size_t r = 0; r < found.size(); ++r)
        add(begin + r / rays_per_point, r % rays_per_point, double{found[r].transmittance});
      if (!step(part * static_cast<double>(end - begin) / static_cast<double>(points_.size())))
        return false;
    }
    return true;
  }

  void measure_rings() {
    const std::vector<ZenithRing> rings = zenith_rings(options_.rings);
    const int each = std::max(1, options_.rays / kSets);
    std::vector<SetSums> sums(rings.size(), SetSums(points_.size()));
    for (int set = 0; set < kSets; ++set) {
      std::vector<double> means(points_.size() * rings.size());
      const auto make = [&](std::size_t i, std::vector<Ray>& rays) {
        for (const ZenithRing& ring : rings)
          append_ring_rays(points_[i], ring, each,
                           options_.seed * kSets + static_cast<std::uint32_t>(set),
                           static_cast<std::uint32_t>(i), rays);
      };
      const auto add = [&](std::size_t i, std::size_t r, double transmittance) {
        means[i * rings.size() + r / static_cast<std::size_t>(each)] += transmittance / each;
      };
      if (!trace_rays(rings.size() * static_cast<std::size_t>(each), 1, make, add)) return;
      for (std::size_t k = 0; k < rings.size(); ++k)
        sums[k].add([&](std::size_t i) { return means[i * rings.size() + k]; });
    }
    for (std::size_t k = 0; k < rings.size(); ++k)
      sums[k].store(fmt::format("gap_{}", k + 1), BiasCorrection(), result_.columns);
  }

  void measure_lights() {
    const std::vector<Light>& lights = on_.scene.lights;
    const std::vector<LightLayer> layers = light_layers(lights);
    std::vector<SetSums> sums(3 * layers.size(), SetSums(points_.size())), all = sums;
    for (int set = 0; set < kSets; ++set) {
      const OcclusionOptions of = occlusion_options(set);
      const auto found = irradiance(on_.device, on_.uploaded, lights, points_, normals_,
                                    {of.rays, of.estimator, of.footprint, of.seed});
      for (std::size_t k = 0; k < sums.size(); ++k) {
        const LightLayer& layer = layers[k / 3];
        const auto c = static_cast<unsigned>(k % 3);
        sums[k].add([&](std::size_t i) {
          return sum_of(found, layer, &PointIrradiance::irradiance, i)[c];
        });
        all[k].add([&](std::size_t i) {
          return sum_of(found, layer, &PointIrradiance::unoccluded, i)[c];
        });
      }
      if (!step()) return;
    }
    const std::vector<BiasCorrection> bias = light_bias(layers);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k].store(
          layers[k / 3].name + "_" + "rgb"[k % 3], bias[k / 3],
          [&](std::size_t i) { return all[k].mean(i); }, result_.columns);
  }

  void measure_suns() {
    const std::vector<SunDirection>& suns = options_.suns;
    std::vector<PointColumn> columns(options_.per_sun ? suns.size() : 1);
    for (std::size_t s = 0; s < columns.size(); ++s) {
      columns[s].name = options_.per_sun ? fmt::format("sun_{}", s) : "sun";
      columns[s].values.resize(points_.size());
    }
    std::vector<double> sums(options_.per_sun ? 0 : points_.size());
    const auto make = [&](std::size_t i, std::vector<Ray>& rays) {
      for (const SunDirection& sun : suns)
        rays.push_back(point_ray(points_[i], normals_[i], sun.direction, kSunSolidAngle));
    };
    const auto add = [&](std::size_t i, std::size_t s, double transmittance) {
      const double value = transmittance * double{suns[s].irradiance} *
                           std::max(0.0, double{normals_[i].dot(suns[s].direction)});
      if (options_.per_sun)
        columns[s].values[i] = static_cast<float>(value);
      else
        sums[i] += value;
    };
    if (!trace_rays(suns.size(), 1, make, add)) return;
    for (std::size_t i = 0; i < sums.size(); ++i)
      columns[0].values[i] = static_cast<float>(sums[i]);
    for (PointColumn& column : columns) result_.columns.push_back(std::move(column));
  }

  const SceneOfPoints& on_;
  std::span<const V3f> points_;
  std::span<const V3f> normals_;
  const PointOptions& options_;
  const RenderControl& control_;
  PointResult& result_;
  double steps_ = 0, done_ = 0;
  /// Where exact values are found, too; none where they are exact already.
  std::vector<V3f> sample_points_, sample_normals_;
  int sample_sets_ = 0;
};

void check_points(std::span<const V3f> points, std::span<const V3f> normals) {
  if (points.size() != normals.size())
    throw Error(ErrorKind::usage,
                fmt::format("{} points but {} normals", points.size(), normals.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(points[i][axis]))
        throw Error(ErrorKind::usage,
                    fmt::format("point {} has a coordinate that is not finite", i));
    if (!(std::fabs(normals[i].length() - 1) < 1e-3f))
      throw Error(ErrorKind::usage, fmt::format("the normal of point {} is not a unit vector", i));
  }
}

}  // namespace

void validate(const PointOptions& options) {
  const auto check = [](const char* flag, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw Error(ErrorKind::usage,
                fmt::format("{} is {}; it must be from {} to {}", flag, value, low, high));
  };
  check("--rays", options.rays, kSets, 1 << 20);
  check("--rings", options.rings, 0, 90);
  check("--footprint", double{options.footprint}, 0, 1e6);
  check("--ao-distance", double{options.distance}, 0, 1e30);
  check("--periodic", double{options.period_x}, 0, 1e30);
  check("--periodic", double{options.period_z}, 0, 1e30);
  if ((options.period_x > 0) != (options.period_z > 0))
    throw Error(ErrorKind::usage, "--periodic needs two periods above 0");
}

PointResult measure_points(Scene scene, std::span<const V3f> points, std::span<const V3f> normals,
                           const PointOptions& options, const RenderControl& control) {
  validate(options);
  check_points(points, normals);
  PointResult result;
  const Stopwatch building;
  const SceneOfPoints on(std::move(scene), options);
  result.build_seconds = building.seconds();
  result.device = on.device.info().name;
  result.notes = on.scene.warnings;
  const Stopwatch tracing;
  Measurement(on, points, normals, options, control, result).run();
  result.trace_seconds = tracing.seconds();
  return result;
}

}  // namespace dapple
