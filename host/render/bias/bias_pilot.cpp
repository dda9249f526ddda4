#include "render/bias/bias_pilot.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "camera/camera_splitting.hpp"
#include "passes/camera_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/shading_pass.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

constexpr std::size_t kUnitPixels = std::size_t{kBiasUnit} * kBiasUnit;

/// Units whose camera rays are traced at once, and about how many of their occlusion rays.
constexpr std::size_t kUnitsAtOnce = 512, kRaysAtOnce = 1u << 20;

/// Rays of a kind from one point: more tell little of the picture's bias, and fill the memory.
constexpr int kMostRaysOfPoint = 4;

/// Rays of all layers that are kept, of 56 bytes each with what is found.
constexpr std::size_t kMostRaysKept = 1u << 24;

/// Fewest units that are worth a launch, and how many times the units that seem to be missing are
/// taken: experiment 545.
constexpr std::size_t kFewestUnits = 16;
constexpr double kSpareUnits = 1.1;

/// Units in an order whose beginnings are evenly spread: by the height of a lattice of two
/// dimensions above each (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences",
/// 2018).
std::vector<std::uint32_t> spread_units(const UnitGrid& grid) {
  const auto step = [](double part) { return static_cast<std::uint32_t>(part * 0x1p32 + 0.5); };
  const auto height = [&](std::uint32_t unit) {
    return grid.column(unit) * step(kPairSteps[0]) + grid.row(unit) * step(kPairSteps[1]);
  };
  std::vector<std::uint32_t> order(grid.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return height(a) < height(b); });
  return order;
}

}  // namespace

BiasPilot::BiasPilot(DeviceContext& context, const DeviceBuffers& scene, const View& view,
                     const RenderOptions& options, const FilmLayout& layout,
                     const CameraParams& camera)
    : context_(context),
      scene_(scene),
      options_(options),
      layout_(layout),
      picture_rays_(context, scene, view, options, layout, kMostRaysOfPoint),
      camera_(camera),
      grid_(view),
      order_(spread_units(grid_)),
      units_at_once_(std::min(kUnitsAtOnce, order_.size())),
      most_units_(order_.size() * static_cast<std::size_t>(options.spp) /
                  splitting_factor(options)),
      units_(grid_.empty_units()),
      layers_((options.ao ? 1 : 0) + layout.lights.size()) {
  camera_.keep_hits = layout.normals ? 1u : 0u;
  const int asked =
      std::max(options.ao ? options.ao_rays : 1, layout.lights.empty() ? 1 : options.light_rays);
  const int rays = std::min(asked, kMostRaysOfPoint);
  const std::size_t of_unit = kUnitPixels * splitting_factor(options);
  const std::size_t most = kRaysAtOnce / (of_unit * static_cast<std::size_t>(rays));
  units_at_once_ = std::clamp(most, std::size_t{1}, units_at_once_);
  const std::size_t samples = units_at_once_ * of_unit;
  queues_ = make_queues(context, samples, static_cast<std::size_t>(rays));
  queues_.work = context.allocate(samples * sizeof(PixelWork));
  traced_ = make_queues(context, kQueryRays, 1);
}

std::size_t BiasPilot::rays() const {
  std::size_t least = layers_.front().rays.size();
  for (const Layer& layer : layers_) least = std::min(least, layer.rays.size());
  return least;
}

void BiasPilot::limit(double share) {
  most_units_ = static_cast<std::size_t>(std::ceil(share * static_cast<double>(most_units_)));
}

double BiasPilot::seen() const {
  if (options_.target_error > 0) return 1;
  return tried_ > 0 ? seen_ / tried_ : 0;
}

void BiasPilot::grow(std::size_t rays) {
  rays = std::min(rays, kMostRaysKept / layers_.size());
  while (this->rays() < rays && !is_complete()) take_units(units_for(rays - this->rays()));
}

// How many units probably give so many rays, by what the units so far gave.
std::size_t BiasPilot::units_for(std::size_t rays) const {
  const double least =
      std::min(layers_.front().params.rays_per_point, layers_.back().params.rays_per_point);
  const double of_unit = this->rays() > 0
                             ? static_cast<double>(this->rays()) / static_cast<double>(next_)
                             : kUnitPixels * std::max(1.0, least);
  const double units = kSpareUnits * static_cast<double>(rays) / of_unit;
  return std::min(std::max(static_cast<std::size_t>(units), kFewestUnits), units_at_once_);
}

// Camera rays of the next units, one for each pixel, and their occlusion rays.
void BiasPilot::take_units(std::size_t count) {
  const std::uint32_t splitting = splitting_factor(options_);
  std::vector<PixelWork> work;
  std::vector<std::uint32_t> units;  // by entry of the work
  for (; count > 0 && !is_complete(); --count, ++next_) {
    const std::uint32_t unit = order_[next_ % order_.size()];
    const auto first = static_cast<std::uint32_t>(next_ / order_.size()) * splitting;
    for (const std::uint32_t pixel : grid_.pixels(unit)) {
      work.push_back({pixel, first});
      units.push_back(unit);
    }
  }
  context_.write(queues_.work, work.data(), work.size() * sizeof(PixelWork));
  camera_.slice = {0, static_cast<uint>(work.size()), 0, splitting};
  camera_pass(context_, scene_, queues_, camera_);
  if (layout_.normals)
    move_points_pass(context_, scene_, queues_, picture_rays_.viewpoint(), work.size() * splitting);
  const std::uint32_t hits = compact_pass(context_, queues_, work.size() * splitting);
  tried_ += static_cast<double>(work.size());
  if (hits == 0) return;
  const std::vector<std::uint32_t> of_hits = count_hits(units);
  std::size_t layer = 0;
  if (options_.ao) keep(layers_[layer++], of_hits, picture_rays_.make_ao(queues_, hits));
  for (std::uint32_t light = 0; light < layout_.lights.size(); ++light)
    keep(layers_[layer++], of_hits, picture_rays_.make_light(queues_, light, hits));
}

// The unit of each sample that hit; counts pixels that show geometry. `units`: by camera ray.
std::vector<std::uint32_t> BiasPilot::count_hits(const std::vector<std::uint32_t>& units) {
  const std::uint32_t splitting = splitting_factor(options_);
  const HostView view = context_.view(queues_.sample_hits);
  const std::span<const SampleHits> records = view.values<SampleHits>();
  std::vector<std::uint32_t> of_hits;
  for (std::uint32_t entry = 0; entry < units.size(); ++entry) {
    const std::size_t before = of_hits.size();
    for (std::uint32_t s = entry * splitting; s < (entry + 1) * splitting; ++s)
      if (records[s / DAPPLE_HIT_BITS].hits >> s % DAPPLE_HIT_BITS & 1u)
        of_hits.push_back(units[entry]);
    if (of_hits.size() == before) continue;
    units_[units[entry]].count += 1;
    seen_ += 1;
  }
  return of_hits;
}

// Keeps the rays of the queue and their exact transmittances.
void BiasPilot::keep(Layer& layer, const std::vector<std::uint32_t>& units,
                     const OcclusionParams& params) {
  const std::size_t before = layer.rays.size();
  layer.params = params;
  layer.units.insert(layer.units.end(), units.begin(), units.end());
  layer.rays.resize(before + params.ray_count);
  context_.read(queues_.rays, &layer.rays[before], params.ray_count * sizeof(Ray));
  trace(layer, Estimator::exact, 0, layer.exact);
}

void BiasPilot::trace(const Layer& layer, Estimator estimator, float footprint,
                      std::vector<float>& found) {
  std::vector<Occlusion> of_slice;
  while (found.size() < layer.rays.size()) {
    OcclusionParams params = layer.params;
    const std::size_t slice = kQueryRays / params.rays_per_point * params.rays_per_point;
    params.footprint = footprint;
    params.ray_count = static_cast<uint>(std::min(slice, layer.rays.size() - found.size()));
    context_.write(traced_.rays, &layer.rays[found.size()], params.ray_count * sizeof(Ray));
    occlusion_pass(context_, traced_, scene_, "bias pilot", estimator, params, RayOrder::by_pixel);
    of_slice.resize(params.ray_count);
    context_.read(traced_.occlusions, of_slice.data(), of_slice.size() * sizeof(Occlusion));
    for (const Occlusion& occlusion : of_slice) found.push_back(occlusion.transmittance);
  }
}

std::vector<Bias> BiasPilot::bias(float footprint) {
  std::vector<Bias> out;
  for (std::size_t i = 0; i < layers_.size(); ++i)
    if (!layers_[i].rays.empty())
      out.push_back(bias_of(layers_[i], !options_.ao || i > 0, footprint));
  return out;
}

Bias BiasPilot::bias_of(Layer& layer, bool is_light, float footprint) {
  if (layer.footprint != footprint) layer.prefiltered.clear();
  layer.footprint = footprint;
  trace(layer, Estimator::prefiltered, footprint, layer.prefiltered);
  std::vector<BiasUnit> units = units_;
  std::vector<double> weights(units.size());  // without occlusion
  const std::size_t rays = std::max(1u, layer.params.rays_per_point);
  const double factor = 1.0 / static_cast<double>(rays * splitting_factor(options_));
  for (std::size_t i = 0; i < layer.rays.size(); ++i) {
    const std::uint32_t unit = layer.units[i / rays];
    const double weight = factor * double{layer.rays[i].weight};
    weights[unit] += weight;
    units[unit].difference += weight * (double{layer.prefiltered[i]} - double{layer.exact[i]});
  }
  double largest = is_light ? 0 : 1;
  for (std::size_t i = 0; i < units.size() && is_light; ++i)
    if (units[i].count > 0) largest = std::max(largest, weights[i] / units[i].count);
  for (BiasUnit& unit : units) unit.difference /= largest > 0 ? largest : 1;
  const auto seen = std::count_if(units.begin(), units.end(),
                                  [](const BiasUnit& unit) { return unit.count > 0; });
  Bias bias = estimate_bias(std::move(units), 1);
  bias.error =
      bias_error(bias.error, static_cast<double>(seen), static_cast<double>(layer.rays.size()));
  return bias;
}

}  // namespace dapple
