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
#include "points/bias_sample.hpp"
#include "points/local_footprint.hpp"
#include "points/option_notes.hpp"
#include "points/periodic.hpp"
#include "points/point_ray.hpp"
#include "points/ray_slices.hpp"
#include "points/ring_rays.hpp"
#include "points/set_sums.hpp"
#include "points/sun_irradiance.hpp"
#include "render/option_check.hpp"
#include "render/queries/point_checks.hpp"
#include "render/queries/point_occlusion.hpp"
#include "render/stopwatch.hpp"
#include "sampling/random_choice.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

using Imath::V3d;

class Measurement {
 public:
  Measurement(const SceneOfPoints& on, std::span<const V3f> points, std::span<const V3f> normals,
              const PointOptions& options, const RenderControl& control, PointResult& result)
      : on_(on),
        points_(points),
        normals_(normals),
        options_(options),
        control_(control),
        result_(result),
        sample_(on, points, normals, options, [this] { return is_stopped(); }) {
    if (options.ao || options.bent) steps_ += kPointSets;
    if (options.sky_view_factor) steps_ += kPointSets;
    if (options.rings > 0) steps_ += kPointSets;
    if (has_lights()) steps_ += kPointSets;
    if (!options.suns.empty()) steps_ += 1;
  }

  void run() {
    try {
      measure();
    } catch (const Error& error) {
      // A query that was stopped says so by an Error.
      if (!result_.interrupted || error.kind() != ErrorKind::failed) throw;
    }
    if (options_.report_bias > 0) result_.bias = sample_.report();
    if (options_.report_bias > 0 && is_corrected() && !result_.interrupted && result_.bias.empty())
      result_.notes.emplace_back(
          "the bias is not reported: no column has values whose bias is known");
  }

 private:
  void measure() {
    choose_footprint();
    if (options_.ao || options_.bent) measure_ao();
    if (options_.sky_view_factor) measure_sky_view_factor();
    if (options_.rings > 0) measure_rings();
    if (has_lights()) measure_lights();
    if (!options_.suns.empty()) measure_suns();
  }

  [[nodiscard]] bool has_lights() const { return options_.lights && !on_.scene.lights.empty(); }

  /// False: stopped.
  bool step(double part = 1) {
    done_ += part;
    if (control_.progress) control_.progress(std::min(1.0, done_ / steps_));
    return !is_stopped();
  }

  bool is_stopped() {
    result_.interrupted = result_.interrupted || (control_.stop && control_.stop());
    return result_.interrupted;
  }

  /// Stops a query between two of its slices: one set of many points can take minutes.
  RenderControl stopping() {
    RenderControl control;
    control.stop = [this] { return is_stopped(); };
    return control;
  }

  [[nodiscard]] OcclusionOptions occlusion_options(int set) const {
    return rays_of_set(options_, set);
  }

  /// Adds a note about a correction.
  const BiasCorrection& noted(const std::string& name, const BiasCorrection& correction) {
    const std::string note = correction.note(name);
    if (!note.empty()) result_.notes.push_back(note);
    return correction;
  }

  [[nodiscard]] bool is_corrected() const {
    return options_.estimator == Estimator::prefiltered && options_.footprint > 0;
  }

  /// None where rays are exact.
  BiasCorrection correction(BiasCorrection (BiasSample::*of)()) {
    return is_corrected() ? (sample_.*of)() : BiasCorrection();
  }

  void choose_footprint() {
    const float most = options_.max_bias.value_or(0);
    if (most > 0 && !is_corrected()) result_.notes.emplace_back(kNothingToLimit);
    if ((most > 0 || !options_.max_bias) && !sample_.is_empty()) {
      const FootprintChoice choice =
          most > 0 ? dapple::choose_footprint(sample_, {options_.footprint, most, 0, true})
                   : choose_local_footprint(sample_, options_.footprint, options_.rays);
      options_.footprint = choice.footprint;
      if (!choice.note.empty()) result_.notes.push_back(choice.note);
    }
    sample_.use_footprint(options_.footprint);
    result_.footprint = options_.footprint;
  }

  void measure_ao() {
    SetSums sums(points_.size());
    std::vector<V3f> bent(points_.size(), V3f(0, 0, 0));
    for (int set = 0; set < kPointSets; ++set) {
      OcclusionOptions options = occlusion_options(set);
      options.distance = options_.distance;
      options.falloff = options_.falloff;
      const PointOcclusion found = point_occlusion(on_.device, on_.uploaded, {points_, normals_},
                                                   options, options_.bent, stopping());
      sums.add([&](std::size_t i) { return double{found.ao[i]}; });
      for (std::size_t i = 0; i < found.bent.size(); ++i) bent[i] += found.bent[i];
      if (!step()) return;
    }
    if (options_.ao) sums.store("ao", noted("ao", correction(&BiasSample::of_ao)), result_.columns);
    for (int axis = 0; axis < 3 && options_.bent; ++axis) {
      PointColumn column{std::string("bent_") + "xyz" [axis], {}};
      for (const V3f& b : bent) column.values.push_back(b.normalized()[axis]);
      result_.columns.push_back(std::move(column));
    }
  }

  void measure_sky_view_factor() {
    const std::vector<V3f> up(points_.size(), V3f(0, 1, 0));
    SetSums sums(points_.size());
    for (int set = 0; set < kPointSets; ++set) {
      QueryPoints query{points_, up};
      query.surfaces = normals_;
      const std::vector<float> found = point_occlusion(on_.device, on_.uploaded, query,
                                                       occlusion_options(set), false, stopping())
                                           .ao;
      sums.add([&](std::size_t i) { return double{found[i]}; });
      if (!step()) return;
    }
    sums.store("sky_view_factor",
               noted("sky_view_factor", correction(&BiasSample::of_sky_view_factor)),
               result_.columns);
  }

  /// trace_slices(), which is `part` of a step.
  template <class Make, class Add>
  bool trace_rays(std::size_t rays_per_point, double part, const Make& make, const Add& add) {
    return trace_slices(
        on_, {points_.size(), rays_per_point, options_.estimator, options_.footprint}, make, add,
        [&](std::size_t count) {
          return step(part * static_cast<double>(count) / static_cast<double>(points_.size()));
        });
  }

  void measure_rings() {
    const std::vector<ZenithRing> rings = zenith_rings(options_.rings);
    std::vector<SetSums> sums(rings.size(), SetSums(points_.size()));
    for (int set = 0; set < kPointSets; ++set) {
      const std::vector<double> means =
          gap_fractions(on_, rings, points_, normals_, occlusion_options(set),
                        [&](double part) { return step(part); });
      if (result_.interrupted) return;
      for (std::size_t k = 0; k < rings.size(); ++k)
        sums[k].add([&](std::size_t i) { return means[i * rings.size() + k]; });
    }
    std::vector<BiasCorrection> bias(rings.size());
    if (is_corrected()) bias = sample_.of_rings(rings);
    for (std::size_t k = 0; k < rings.size(); ++k) {
      const std::string name = gap_name(k);
      sums[k].store(name, noted(name, bias[k]), result_.columns);
    }
  }

  void measure_lights() {
    const std::vector<Light>& lights = on_.scene.lights;
    const std::vector<LightLayer> layers = light_layers(lights);
    std::vector<SetSums> sums(3 * layers.size(), SetSums(points_.size()));
    std::vector<std::vector<double>> all(sums.size(), std::vector<double>(points_.size()));
    for (int set = 0; set < kPointSets; ++set) {
      const OcclusionOptions of = occlusion_options(set);
      const auto found = irradiance(on_.device, on_.uploaded, lights, points_, normals_,
                                    {of.rays, of.estimator, of.footprint, of.seed}, stopping());
      for (std::size_t k = 0; k < sums.size(); ++k) {
        const LightLayer& layer = layers[k / 3];
        const auto c = static_cast<unsigned>(k % 3);
        const auto whole = [&](std::size_t i) {
          return sum_of(found, layer, &PointIrradiance::unoccluded, i)[c];
        };
        sums[k].add(
            [&](std::size_t i) { return sum_of(found, layer, &PointIrradiance::irradiance, i)[c]; },
            whole);
        for (std::size_t i = 0; i < points_.size(); ++i) all[k][i] += whole(i) / kPointSets;
      }
      if (!step()) return;
    }
    std::vector<BiasCorrection> bias(layers.size());
    if (is_corrected()) bias = sample_.of_lights(layers);
    for (std::size_t l = 0; l < layers.size(); ++l) noted(layers[l].name, bias[l]);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k].store(
          layers[k / 3].name + "_" + "rgb"[k % 3], bias[k / 3],
          [&](std::size_t i) { return all[k][i]; }, result_.columns);
  }

  void measure_suns() {
    if (options_.per_sun)
      trace_each_sun();
    else
      sample_suns();
  }

  void sample_suns() {
    const SunRays suns(options_.suns);
    SetSums sums(points_.size());
    const auto parts = sun_parts(on_, suns, points_, normals_, options_, kPointSets, options_.seed,
                                 [&](double part) { return step(part); });
    if (result_.interrupted) return;
    std::vector<double> unoccluded;
    for (const V3f& normal : normals_) unoccluded.push_back(suns.unoccluded(normal));
    const auto whole = [&](std::size_t i) { return unoccluded[i]; };
    for (const std::vector<double>& part : parts)
      sums.add([&](std::size_t i) { return part[i] * whole(i); }, whole);
    BiasCorrection bias;
    if (is_corrected()) bias = noted("sun", sample_.of_suns());
    sums.store("sun", bias, whole, result_.columns);
  }

  void trace_each_sun() {
    const std::vector<SunDirection>& suns = options_.suns;
    std::vector<PointColumn> columns(suns.size());
    for (std::size_t s = 0; s < columns.size(); ++s) {
      columns[s].name = fmt::format("sun_{}", s);
      columns[s].values.resize(points_.size());
    }
    const auto make = [&](std::size_t i, std::span<Ray> rays) {
      const std::uint32_t of_point = hash_of(options_.seed, static_cast<std::uint32_t>(i));
      for (std::size_t s = 0; s < suns.size(); ++s) {
        const std::uint32_t bits = hash_of(of_point, static_cast<std::uint32_t>(s));
        const V3f direction = direction_to_disk(suns[s].direction, (bits & 0xffffu) / 65536.0,
                                                (bits >> 16) / 65536.0);
        rays[s] =
            point_ray(points_[i], normals_[i], direction, kSunSolidAngle, hash_of(bits, of_point));
      }
    };
    const auto add = [&](std::size_t i, std::size_t s, double transmittance) {
      const double value = transmittance * double{suns[s].irradiance} *
                           std::max(0.0, double{normals_[i].dot(suns[s].direction)});
      columns[s].values[i] = static_cast<float>(value);
    };
    if (!trace_rays(suns.size(), 1, make, add)) return;
    for (PointColumn& column : columns) result_.columns.push_back(std::move(column));
  }

  const SceneOfPoints& on_;
  std::span<const V3f> points_;
  std::span<const V3f> normals_;
  PointOptions options_;
  const RenderControl& control_;
  PointResult& result_;
  BiasSample sample_;
  double steps_ = 0, done_ = 0;
};

void check_suns(const std::vector<SunDirection>& suns) {
  for (std::size_t i = 0; i < suns.size(); ++i) {
    const auto& [direction, irradiance] = suns[i];
    if (!(std::fabs(direction.length() - 1) < 1e-3f))
      throw Error(ErrorKind::usage,
                  fmt::format("the direction of sun {} is not a unit vector: ({}, {}, {})", i,
                              direction.x, direction.y, direction.z));
    if (!(irradiance >= 0 && std::isfinite(irradiance)))
      throw Error(ErrorKind::usage, fmt::format("the irradiance of sun {} is {}; it must be finite "
                                                "and not negative",
                                                i, irradiance));
  }
}

}  // namespace

void validate(const PointOptions& options) {
  check_range("--rays", options.rays, kPointSets, 1 << 20);
  check_range("--rings", options.rings, 0, 90);
  check_ray_options(options);
  check_range("--max-bias", options.max_bias.value_or(0), 0, 1);
  check_range("--periodic", options.period_x, 0, 1e30f);
  check_range("--periodic", options.period_z, 0, 1e30f);
  if ((options.period_x > 0) != (options.period_z > 0))
    throw Error(ErrorKind::usage, "--periodic needs two periods above 0");
}

PointResult measure_points(Scene scene, std::span<const V3f> points, std::span<const V3f> normals,
                           const PointOptions& options, const RenderControl& control) {
  validate(options);
  check_points("measure_points", points, normals);
  check_suns(options.suns);
  PointResult result;
  const Stopwatch preparing;
  result.notes = option_notes(options, scene, points);
  std::vector<V3f> in_period;
  if (options.period_x > 0) {
    check_scene(scene);
    if (!options.lights || !has_placed_light(scene)) {
      in_period = points_in_period(scene, options.period_x, options.period_z, points);
      points = in_period;
    }
    repeat(scene, options.period_x, options.period_z, points);
  }
  const SceneOfPoints on(std::move(scene), options);
  result.build_seconds = on.build_seconds;
  result.prepare_seconds = preparing.seconds() - on.build_seconds;
  result.device = on.device.info().name;
  result.notes.insert(result.notes.end(), on.scene.warnings.begin(), on.scene.warnings.end());
  const Stopwatch tracing;
  Measurement(on, points, normals, options, control, result).run();
  result.trace_seconds = tracing.seconds();
  return result;
}

}  // namespace dapple
