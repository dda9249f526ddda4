#include "points/bias_sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"
#include "points/sun_irradiance.hpp"
#include "render/queries/point_occlusion.hpp"
#include "sampling/bias_estimate.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

using Imath::V3d;

/// Values of points, each from one set, that are also found exactly; and of each point at least
/// these, so that what differs at a point is told from noise.
constexpr std::size_t kBiasSamples = 2048, kFewestSets = 2;

/// Neighbouring points of the sample that are a tile.
constexpr std::uint32_t kPointsOfTile = 16;

/// Up to `most` of `count` numbers, ascending and evenly spread.
std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen(std::min(count, most));
  for (std::uint32_t i = 0; i < chosen.size(); ++i)
    chosen[i] = count > most ? spread_choice(i, count) : i;
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

std::string gap_name(std::size_t ring) { return fmt::format("gap_{}", ring + 1); }

V3d sum_of(const std::vector<PointIrradiance>& found, const LightLayer& layer,
           std::vector<V3f> PointIrradiance::*which, std::size_t i) {
  V3d sum(0, 0, 0);
  for (const std::size_t light : layer.lights) sum += V3d((found[light].*which)[i]);
  return sum;
}

BiasSample::BiasSample(const SceneOfPoints& on, std::span<const V3f> points,
                       std::span<const V3f> normals, const PointOptions& options, Stop stop)
    : on_(on), options_(options), stop_(std::move(stop)) {
  if (points.empty() || options.estimator == Estimator::exact || !(options.footprint > 0)) return;
  constexpr std::size_t most = kBiasSamples / kFewestSets;
  for (const std::size_t i : evenly_chosen(points.size(), most)) {
    points_.push_back(points[i]);
    normals_.push_back(normals[i]);
  }
  const std::size_t sets = (kBiasSamples + points_.size() - 1) / points_.size();
  sets_ = static_cast<int>(std::min<std::size_t>(kPointSets, sets));
  share_of_points_ = static_cast<double>(points_.size()) / static_cast<double>(points.size());
  share_ = share_of_points_ * sets_ / kPointSets;
}

RenderControl BiasSample::control() const {
  RenderControl control;
  control.stop = stop_;
  return control;
}

std::vector<BiasCorrection> BiasSample::compare(const std::vector<std::string>& names,
                                                const Find& find) {
  std::vector<Values>& exact = exact_[names.front()];  // of any footprint
  const bool is_known = !exact.empty();
  exact.resize(names.size());
  std::vector<Values> prefiltered(names.size());
  for (int set = 0; set < sets_; ++set) {
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      if (estimator == Estimator::exact && is_known) continue;
      OcclusionOptions options = rays_of_set(options_, set);
      options.estimator = estimator;
      const std::vector<Values> found = find(options);
      if (stop_()) throw Error(ErrorKind::failed, "the measurement was stopped");
      std::vector<Values>& all = estimator == Estimator::exact ? exact : prefiltered;
      for (std::size_t k = 0; k < names.size(); ++k) {
        all[k].values.insert(all[k].values.end(), found[k].values.begin(), found[k].values.end());
        all[k].points.insert(all[k].points.end(), found[k].points.begin(), found[k].points.end());
      }
    }
  }
  std::vector<BiasCorrection> corrections;
  for (std::size_t k = 0; k < names.size(); ++k) {
    BiasCorrection& correction = corrections.emplace_back(exact[k].values, prefiltered[k].values,
                                                          exact[k].points, share_of_points_);
    const std::size_t values = exact[k].values.size();
    if (values == 0) continue;
    // By tiles of points, and by points.
    std::vector<BiasUnit> units(points_.size()), single(values);
    for (std::uint32_t i = 0; i < units.size(); ++i) units[i].tile = i / kPointsOfTile;
    for (std::size_t v = 0; v < values; ++v) {
      const std::uint32_t point = exact[k].points[v];
      const double value = prefiltered[k].values[v];
      const double left = value + correction.change(fall_with_depth(value)) - exact[k].values[v];
      units[point].count += 1;
      units[point].difference += left;
      single[v] = {point, 1, left};
    }
    Bias bias = estimate_bias(std::move(units), share_);
    of_points_.push_back(estimate_bias(std::move(single), share_));
    correction.set_local_bias(std::max(bias.tile_rmse, of_points_.back().tile_rmse));
    const double rays = static_cast<double>(values) * rays_of_set(options_, 0).rays;
    if (correction.is_measured()) {
      bias.mean = correction.mean_bias();
      bias.error = correction.mean_error();
    }
    const std::size_t count = correction.is_measured() ? values : points_.size();
    bias.error = bias_error(bias.error, static_cast<double>(count), rays);
    bias_[names[k]] = bias;
  }
  return corrections;
}

BiasCorrection BiasSample::of_occlusion(const std::string& name, const std::vector<V3f>& normals,
                                        float distance, float falloff) {
  return compare({name}, [&](OcclusionOptions options) {
    options.distance = distance;
    options.falloff = falloff;
    QueryPoints query{points_, normals};
    query.surfaces = normals_;
    const auto found =
        point_occlusion(on_.device, on_.uploaded, query, options, false, control()).ao;
    std::vector<Values> of_one(1);
    for (std::uint32_t i = 0; i < found.size(); ++i) {
      of_one[0].values.push_back(double{found[i]});
      of_one[0].points.push_back(i);
    }
    return of_one;
  })[0];
}

BiasCorrection BiasSample::of_sky_view_factor() {
  return of_occlusion("sky_view_factor", std::vector<V3f>(points_.size(), V3f(0, 1, 0)), 0, 0);
}

std::vector<BiasCorrection> BiasSample::of_lights(const std::vector<LightLayer>& layers) {
  std::vector<std::string> names;
  for (const LightLayer& layer : layers) names.push_back("light." + layer.name);
  return compare(names, [&](const OcclusionOptions& of) {
    const auto found = irradiance(on_.device, on_.uploaded, on_.scene.lights, points_, normals_,
                                  {of.rays, of.estimator, of.footprint, of.seed}, control());
    const V3d one(1, 1, 1);
    std::vector<Values> of_layers(layers.size());
    for (std::size_t l = 0; l < layers.size(); ++l)
      for (std::uint32_t i = 0; i < points_.size(); ++i) {
        const double all = sum_of(found, layers[l], &PointIrradiance::unoccluded, i).dot(one);
        if (!(all > 0)) continue;
        of_layers[l].values.push_back(
            sum_of(found, layers[l], &PointIrradiance::irradiance, i).dot(one) / all);
        of_layers[l].points.push_back(i);
      }
    return of_layers;
  });
}

std::vector<BiasCorrection> BiasSample::of_rings(const std::vector<ZenithRing>& rings) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < rings.size(); ++k) names.push_back(gap_name(k));
  return compare(names, [&](const OcclusionOptions& of) {
    const auto means =
        gap_fractions(on_, rings, points_, normals_, of, [&](double) { return !stop_(); });
    std::vector<Values> of_rings(rings.size());
    for (std::size_t k = 0; k < rings.size(); ++k)
      for (std::uint32_t i = 0; i < points_.size(); ++i) {
        of_rings[k].values.push_back(means[i * rings.size() + k]);
        of_rings[k].points.push_back(i);
      }
    return of_rings;
  });
}

BiasCorrection BiasSample::of_suns() {
  const SunRays suns(options_.suns);
  return compare({"sun"}, [&](const OcclusionOptions& of) {
    PointOptions options = options_;
    options.estimator = of.estimator;
    const auto parts = sun_parts(on_, suns, points_, normals_, options, 1, of.seed,
                                 [&](double) { return !stop_(); });
    std::vector<Values> of_one(1);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (!(suns.unoccluded(normals_[i]) > 0)) continue;
      of_one[0].values.push_back(parts[0][i]);
      of_one[0].points.push_back(i);
    }
    return of_one;
  })[0];
}

std::vector<Bias> BiasSample::bias(float footprint) {
  const float used = options_.footprint;
  options_.footprint = footprint;
  bias_.clear();
  of_points_.clear();
  if (options_.ao) of_ao();
  if (options_.sky_view_factor) of_sky_view_factor();
  if (options_.lights && !on_.scene.lights.empty()) of_lights(light_layers(on_.scene.lights));
  if (options_.rings > 0) of_rings(zenith_rings(options_.rings));
  if (is_sampled(options_)) of_suns();
  std::vector<Bias> layers;
  for (const auto& [name, bias] : bias_) layers.push_back(bias);
  for (Bias& bias : of_points_) {
    bias.mean = bias.error = 0;  // that is told above
    layers.push_back(bias);
  }
  bias_.clear();
  options_.footprint = used;
  return layers;
}

}  // namespace dapple
