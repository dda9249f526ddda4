#include "bake/bake_bias.hpp"

#include <algorithm>
#include <cmath>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// Consecutive samples that are chosen together and are a unit.
constexpr std::size_t kBlock = 64;

/// Units of a tile.
constexpr std::uint32_t kUnitsOfTile = 4;

/// Comparing may take this part of the time of tracing; beyond it fewer samples are compared.
constexpr double kMostOfTime = 0.04;

}  // namespace

std::vector<BiasUnit> differences(std::span<const SurfaceSample> samples,
                                  const TracedSamples& prefiltered, const TracedSamples& exact) {
  std::vector<BiasUnit> units((samples.size() + kBlock - 1) / kBlock);
  const auto add = [](BiasUnit& unit, const SideValue& a, const SideValue& b) {
    unit.count += 1;
    unit.difference += double{a.scalar} - double{b.scalar};
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (exact.is_inside(i)) continue;
    BiasUnit& unit = units[i / kBlock];
    if (samples[i].front) add(unit, prefiltered.front[i], exact.front[i]);
    if (samples[i].back) add(unit, prefiltered.back[i], exact.back[i]);
  }
  for (std::uint32_t u = 0; u < units.size(); ++u) units[u].tile = u / kUnitsOfTile;
  return units;
}

TraceSamples BakeBias::with(BiasTracing tracing) {
  if (!(share_ > 0)) return tracing.values;
  std::deque<Compared>& meshes = quantities_[tracing.name].meshes;
  meshes.emplace_back();
  return [this, tracing = std::move(tracing), mesh = meshes.size() - 1](
             std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
             const Placements& placements, int rays, std::uint32_t hash) {
    const Stopwatch watch;
    TracedSamples found = tracing.values(samples, placement, placements, rays, hash);
    seconds_ += watch.seconds();
    Quantity& quantity = quantities_[tracing.name];
    quantity.largest = std::max(quantity.largest, found.largest);
    quantity.meshes[mesh].samples += static_cast<double>(samples.size());
    samples_ += static_cast<double>(samples.size());
    compare(tracing, samples, placement, placements, rays, hash, quantity.meshes[mesh]);
    return found;
  };
}

void BakeBias::compare(const BiasTracing& tracing, std::span<const SurfaceSample> samples,
                       std::span<const std::uint32_t> placement, const Placements& placements,
                       int rays, std::uint32_t hash, Compared& mesh) {
  std::vector<SurfaceSample> chosen;
  std::vector<std::uint32_t> places;
  for (std::size_t begin = 0; begin < samples.size(); begin += kBlock) {
    if (!is_in_share(next_block_++, share_)) continue;
    const std::size_t end = std::min(begin + kBlock, samples.size());
    chosen.insert(chosen.end(), samples.begin() + begin, samples.begin() + end);
    places.insert(places.end(), placement.begin() + begin, placement.begin() + end);
  }
  if (chosen.empty()) return;
  const Stopwatch watch;
  const std::uint32_t first = mesh.units.empty() ? 0 : mesh.units.back().tile + 1;
  for (BiasUnit unit :
       differences(chosen, tracing.prefiltered(chosen, places, placements, rays, hash),
                   tracing.exact(chosen, places, placements, rays, hash))) {
    if (unit.count == 0) continue;
    mesh.rays += rays * unit.count;
    unit.tile += first;
    mesh.units.push_back(unit);
  }
  mesh.compared += static_cast<double>(chosen.size());
  compared_samples_ += static_cast<double>(chosen.size());
  compared_seconds_ += watch.seconds();
  limit_time();
}

// By the clock: what is baked does not depend on it.
void BakeBias::limit_time() {
  if (!(samples_ > 0 && compared_seconds_ > 0)) return;
  const double times = compared_seconds_ / compared_samples_ * samples_ / seconds_;
  share_ = std::min(most_, kMostOfTime / times);
}

// Of all meshes, each of which counts by its samples: of later ones less may have been compared.
std::vector<BiasUnit> BakeBias::units_of(const Quantity& quantity) {
  std::vector<BiasUnit> units;
  const double largest = quantity.largest > 0 ? double{quantity.largest} : 1;
  for (const Compared& mesh : quantity.meshes) {
    const std::uint32_t first = units.empty() ? 0 : units.back().tile + 1;
    for (BiasUnit unit : mesh.units) {
      const double weight = mesh.samples / mesh.compared;
      unit.tile += first;
      unit.count *= weight;
      unit.difference *= weight / largest;
      units.push_back(unit);
    }
  }
  return units;
}

std::map<std::string, Bias> BakeBias::report() const {
  std::map<std::string, Bias> bias;
  for (const auto& [name, quantity] : quantities_) {
    std::vector<BiasUnit> units = units_of(quantity);
    if (units.size() < 2) continue;
    double samples = 0, compared = 0, rays = 0;
    for (const Compared& mesh : quantity.meshes) {
      samples += mesh.samples;
      compared += mesh.compared;
      rays += mesh.rays;
    }
    Bias found = estimate_bias(std::move(units), compared / samples);
    found.error = bias_error(found.error, compared, std::max(1.0, rays));
    bias[name] = found;
  }
  return bias;
}

}  // namespace dapple
