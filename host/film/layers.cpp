#include "film/layers.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "camera/camera_splitting.hpp"
#include "film/light_layers.hpp"
#include "film/light_planes.hpp"
#include "film/sums/film_sums.hpp"
#include "film/traced_picture.hpp"
#include "scene/lights/dark_light.hpp"

namespace dapple {
namespace {

/// EXR cuts channel names at 255 bytes; this leaves room for "error.light." and "_2".
constexpr std::size_t kMaxLayerNameLength = 200;

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Whether `c` is the second or a later byte of a UTF-8 character. In "größe" the characters ö and
/// ß become one underscore each.
bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

class Planes {
 public:
  explicit Planes(std::uint32_t pixels) : pixels_(pixels) {}

  template <class Value>
  void add(const std::string& channel, const Value& value) {
    Plane plane{channel, std::vector<float>(pixels_)};
    tbb::parallel_for(0u, pixels_,
                      [&](std::uint32_t p) { plane.pixels[p] = static_cast<float>(value(p)); });
    planes_.push_back(std::move(plane));
  }
  template <class Value>
  void add3(const std::string& layer, const char (&suffixes)[4], const Value& value) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    const std::size_t first = planes_.size();
    for (int i = 0; i < 3; ++i)
      planes_.push_back({prefix + suffixes[i], std::vector<float>(pixels_)});
    tbb::parallel_for(0u, pixels_, [&](std::uint32_t p) {
      const V3d three = value(p);
      for (std::size_t i = 0; i < 3; ++i)
        planes_[first + i].pixels[p] = static_cast<float>(three[static_cast<int>(i)]);
    });
  }
  std::vector<Plane> take() { return std::move(planes_); }

 private:
  std::uint32_t pixels_;
  std::vector<Plane> planes_;
};

double per_ray(double sum, std::uint64_t rays) {
  return rays ? sum / static_cast<double>(rays) : 0.0;
}

double root_mean_square(const std::vector<float>& values) {
  const double sum = std::transform_reduce(values.begin(), values.end(), 0.0, std::plus<>(),
                                           [](float value) { return double{value} * value; });
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Rays of AO and lights are those of both sides, as their visits are.
void count_visits(const Sums& sums, const TracedPicture& picture, const FilmLayout& layout,
                  const RenderOptions& options, const std::vector<Light>& lights,
                  RenderStatistics& s) {
  const double of_backs =
      options.back ? sums.total(layout.back_samples + DAPPLE_PLANE_BACK_HITS) : 0.0;
  const double hits = sums.total(DAPPLE_PLANE_HITS) + of_backs;
  s.rays.camera =
      std::accumulate(picture.samples.begin(), picture.samples.end(), std::uint64_t{0}) /
      splitting_factor(options);
  s.camera = {per_ray(sums.total(DAPPLE_PLANE_CAMERA_VISITS) / DAPPLE_ITEM_RAYS, s.rays.camera),
              per_ray(sums.total(DAPPLE_PLANE_CAMERA_TESTS) / DAPPLE_ITEM_RAYS, s.rays.camera)};
  if (options.ao) {
    s.rays.ao = static_cast<std::uint64_t>(hits) * static_cast<std::uint64_t>(options.ao_rays);
    s.ao = {per_ray(sums.total(layout.ao_visits()), s.rays.ao),
            per_ray(sums.total(layout.ao_visits() + 1), s.rays.ao)};
  }
  const auto lit = std::count_if(lights.begin(), lights.end(),
                                 [](const Light& light) { return !is_dark(light); });
  s.rays.light = static_cast<std::uint64_t>(hits) * static_cast<std::uint64_t>(options.light_rays) *
                 static_cast<std::uint64_t>(lit);
  double visits = 0, tests = 0;
  for (const LightPlaneRange& planes : layout.lights) {
    visits += sums.total(planes.visits());
    tests += sums.total(planes.visits() + 1);
  }
  s.light = {per_ray(visits, s.rays.light), per_ray(tests, s.rays.light)};
}

/// Adds the layers of node visits and triangle tests: those of a camera ray and of the AO and light
/// rays of its samples, on both sides, as a mean of each pixel.
void add_visits(Planes& planes, const Sums& sums, const TracedPicture& picture,
                const FilmLayout& layout, const RenderOptions& options) {
  const auto total = [&](std::uint32_t p, std::uint32_t which) {
    double sum = sums.at(DAPPLE_PLANE_CAMERA_VISITS + which, p) / DAPPLE_ITEM_RAYS;
    if (options.ao) sum += sums.at(layout.ao_visits() + which, p);
    for (const LightPlaneRange& light : layout.lights) sum += sums.at(light.visits() + which, p);
    return sum * splitting_factor(options) / sample_count(picture, p);
  };
  planes.add("visits.nodes", [&](std::uint32_t p) { return total(p, 0); });
  planes.add("visits.triangles", [&](std::uint32_t p) { return total(p, 1); });
}

/// The radiance of the sky that AO lets through: the option's; else 1 without lights, 0 beside a
/// dome, which is a sky itself, and beside other lights a tenth of what they reflect from bright
/// white surfaces. A percentile, because a few pixels near a lamp may be a thousand times as
/// bright.
double ambient_of(const RenderOptions& options, const std::vector<Light>& lights,
                  const LightPlanes& light) {
  constexpr double kShare = 0.1, kPercentile = 0.9;
  if (options.ambient) return *options.ambient;
  if (lights.empty()) return 1;
  const bool dome = std::any_of(lights.begin(), lights.end(),
                                [](const Light& l) { return l.kind == LightKind::dome; });
  return dome ? 0 : kShare * light.unoccluded_percentile(kPercentile) / std::numbers::pi;
}

/// Makes the layers of a picture from its sums.
class Layers {
 public:
  Layers(const Sums& sums, const TracedPicture& picture, const FilmLayout& layout,
         const RenderOptions& options, const LightPlanes& light)
      : sums_(sums),
        picture_(picture),
        layout_(layout),
        options_(options),
        light_(light),
        planes_(layout.pixels) {}

  /// RGB is premultiplied by A: camera rays that miss the scene count as 0. Layers of the sky and
  /// of each light add up to it.
  void add_beauty(double ambient, const std::vector<LightLayer>& layers) {
    planes_.add3("", "RGB", [&](std::uint32_t p) {
      V3d sum = ambient * from_sky(p);
      for (const LightLayer& layer : layers) sum += from_lights(layer.lights, p);
      return sum;
    });
    planes_.add("A", [&](std::uint32_t p) { return hits(p) / spp(p); });
    if (!options_.beauty) return;
    planes_.add3("beauty." + ambient_layer_name(layers), "RGB",
                 [&](std::uint32_t p) { return ambient * from_sky(p); });
    for (const LightLayer& layer : layers)
      planes_.add3("beauty." + layer.name, "RGB",
                   [&](std::uint32_t p) { return from_lights(layer.lights, p); });
  }

  void add_ao() {
    planes_.add3("ao", "RGB", [&](std::uint32_t p) { return V3d(ao(p)); });
    if (options_.back)
      planes_.add3("ao.back", "RGB", [&](std::uint32_t p) {
        const std::uint32_t source = light_.back_source(p);
        return V3d(ao_of(layout_.back_ao, source,
                         sums_.at(layout_.back_samples + DAPPLE_PLANE_BACK_HITS, source),
                         back_sample_count(sums_, layout_, source)));
      });
    planes_.add3("bent", "XYZ", [&](std::uint32_t p) {
      const V3d bent = three(layout_.ao + DAPPLE_PLANE_AO_BENT, p);
      return bent.length2() > 0 ? bent.normalized() : V3d(0.0);
    });
  }

  void add_lights(const std::vector<LightLayer>& layers) {
    for (const LightLayer& layer : layers) {
      planes_.add3("light." + layer.name, "RGB",
                   [&](std::uint32_t p) { return light_.sum(layer.lights, p); });
      if (options_.back)
        planes_.add3("light." + layer.name + ".back", "RGB",
                     [&](std::uint32_t p) { return light_.back(layer.lights, p); });
    }
  }

  /// What is seen. Geometric normals are a layer of their own where the shading pass made others.
  void add_surface() {
    if (layout_.albedo) planes_.add3("albedo", "RGB", [&](std::uint32_t p) { return albedo(p); });
    add_mean("N", layout_.normals ? layout_.normals : DAPPLE_PLANE_NORMAL, layout_.unit_scale);
    if (layout_.normals) add_mean("Ng", DAPPLE_PLANE_NORMAL, layout_.unit_scale);
    add_mean("P", DAPPLE_PLANE_POSITION, layout_.position_scale);
    planes_.add("Z", [&](std::uint32_t p) {
      return hits(p) > 0 ? sums_.at(DAPPLE_PLANE_DEPTH, p) / (double{layout_.depth_scale} * hits(p))
                         : std::numeric_limits<double>::infinity();
    });
    for (std::size_t axis = 0; axis < 2 && !picture_.motion.empty(); ++axis)
      planes_.add(axis == 0 ? "motion.X" : "motion.Y", [&](std::uint32_t p) {
        return hits(p) > 0 ? picture_.motion.mean(p, axis, hits(p)) : 0.0;
      });
  }

  /// Samples, costs and estimated errors. `lights`: their names.
  void add_sampling(const std::vector<std::string>& lights, RenderStatistics& statistics) {
    planes_.add("samples",
                [&](std::uint32_t p) { return picture_.samples[p] / splitting_factor(options_); });
    if (options_.visits) add_visits(planes_, sums_, picture_, layout_, options_);
    for (std::size_t pass = 0; pass < picture_.errors.size(); ++pass) {
      const bool is_ao = options_.ao && pass == 0;
      const std::string layer = is_ao ? "ao" : "light." + lights[pass - (options_.ao ? 1 : 0)];
      const std::vector<float>& errors = picture_.errors[pass];
      planes_.add("error." + layer, [&](std::uint32_t p) { return errors[p]; });
      statistics.rmse[layer] = root_mean_square(errors);
    }
  }

  std::vector<Plane> take() { return planes_.take(); }

 private:
  [[nodiscard]] double spp(std::uint32_t p) const { return sample_count(picture_, p); }
  [[nodiscard]] double hits(std::uint32_t p) const { return sums_.at(DAPPLE_PLANE_HITS, p); }
  [[nodiscard]] V3d three(std::uint32_t plane, std::uint32_t p) const {
    return {sums_.at(plane, p), sums_.at(plane + 1, p), sums_.at(plane + 2, p)};
  }
  /// Of the samples that hit.
  [[nodiscard]] V3d mean3(std::uint32_t plane, double scale, std::uint32_t p) const {
    return hits(p) == 0 ? V3d(0.0) : three(plane, p) / (scale * hits(p));
  }
  void add_mean(const char* layer, std::uint32_t plane, double scale) {
    planes_.add3(layer, "XYZ", [&](std::uint32_t p) { return mean3(plane, scale, p); });
  }
  [[nodiscard]] V3d albedo(std::uint32_t p) const {
    return layout_.albedo ? mean3(layout_.albedo, layout_.unit_scale, p) : V3d(1.0);
  }
  /// AO of a plane's sum over `samples`, of which `hit` hit: the others see everything.
  [[nodiscard]] double ao_of(std::uint32_t plane, std::uint32_t p, double hit,
                             double samples) const {
    return sums_.at(plane, p) / (double{layout_.unit_scale} * options_.ao_rays * samples) + 1.0 -
           hit / samples;
  }
  [[nodiscard]] double ao(std::uint32_t p) const {
    return options_.ao ? ao_of(layout_.ao, p, hits(p), spp(p)) : 1.0;
  }

  /// Radiance of surfaces below a sky of radiance 1. Without albedo they are white, without AO
  /// nothing hides the sky.
  [[nodiscard]] V3d from_sky(std::uint32_t p) const {
    if (options_.ao && layout_.albedo)
      return three(layout_.ao_reflected(), p) /
             (double{layout_.unit_scale} * options_.ao_rays * spp(p));
    return albedo(p) * (ao(p) - (1.0 - hits(p) / spp(p)));
  }
  [[nodiscard]] V3d from_lights(const std::vector<std::size_t>& lights, std::uint32_t p) const {
    return (layout_.albedo ? light_.reflected(lights, p) : light_.sum(lights, p)) /
           std::numbers::pi;
  }

  const Sums& sums_;
  const TracedPicture& picture_;
  const FilmLayout& layout_;
  const RenderOptions& options_;
  const LightPlanes& light_;
  Planes planes_;
};

}  // namespace

std::string layer_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (name.size() == kMaxLayerNameLength) break;
    if (!continues_character(c)) name += is_name_character(c) ? c : '_';
  }
  return name.empty() ? "unnamed" : name;
}

std::vector<Plane> develop(const TracedPicture& picture, const FilmLayout& layout,
                           const RenderOptions& options, const std::vector<Light>& lights,
                           RenderStatistics& statistics) {
  const Sums sums(picture.sums.values<std::int64_t>(), layout.pixels);
  const LightPlanes light(sums, picture, layout, options, lights);
  statistics.ambient = ambient_of(options, lights, light);
  Layers layers(sums, picture, layout, options, light);
  const std::vector<LightLayer> of_lights = light_layers(lights);
  layers.add_beauty(statistics.ambient, of_lights);
  if (options.ao) layers.add_ao();
  layers.add_lights(of_lights);
  layers.add_surface();
  layers.add_sampling(light_names(lights), statistics);
  count_visits(sums, picture, layout, options, lights, statistics);
  return layers.take();
}

}  // namespace dapple
