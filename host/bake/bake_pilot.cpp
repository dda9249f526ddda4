#include "bake/bake_pilot.hpp"

#include <algorithm>

#include "bake/vertex_bake.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// The most samples that are compared.
constexpr std::size_t kMostSamples = 1u << 17;

}  // namespace

PilotMesh::PilotMesh(const Mesh& of, const TwoSided& sides, const BakeOptions& options,
                     Placements given)
    : mesh(&of),
      groups(one_group(mesh->positions.size())),
      two_sided(sides.triangles(of)),
      normals(options.normals),
      placements(std::move(given)) {}

BakePilot::BakePilot(const std::vector<PilotMesh>& meshes, std::vector<PilotQuantity> quantities,
                     std::uint32_t seed)
    : meshes_(meshes), quantities_(std::move(quantities)), seed_(seed), triangles_before_{0} {
  for (const PilotMesh& one : meshes_) {
    first_placement_.push_back(static_cast<std::uint32_t>(placements_.to_world.size()));
    for (const M44f& matrix : one.placements.to_world) placements_.add(matrix);
    triangles_before_.push_back(triangles_before_.back() + one.mesh->primitive_count());
  }
  if (triangles_before_.back() > 0) most_ = kMostSamples;
}

// Triangles are chosen so that any number of them is evenly spread.
BakePilot::Batch BakePilot::take(std::size_t count) {
  const std::uint64_t all = triangles_before_.back();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> chosen;  // triangle, number of the sample
  for (; count > 0 && taken_ < most_; --count, ++taken_) {
    const auto number = static_cast<std::uint32_t>(taken_);
    chosen.emplace_back(spread_choice(number, all), number);
  }
  std::sort(chosen.begin(), chosen.end());
  Batch batch;
  batch.hash = hash_of(seed_, static_cast<std::uint32_t>(batches_.size()));
  for (const auto& [triangle, number] : chosen) {
    const auto m = static_cast<std::size_t>(
        std::upper_bound(triangles_before_.begin(), triangles_before_.end(), triangle) -
        triangles_before_.begin() - 1);
    const PilotMesh& of = meshes_[m];
    const auto t = static_cast<std::size_t>(triangle - triangles_before_[m]);
    if (!has_area(*of.mesh, t)) continue;
    const SampledTriangles triangles{*of.mesh, of.groups, of.two_sided, of.normals};
    batch.samples.push_back(sample_triangle(triangles, t, hash_of(seed_, number) & 0xffffu));
    const auto placements = static_cast<std::uint32_t>(of.placements.to_world.size());
    batch.placement.push_back(first_placement_[m] + hash_of(number, seed_) % placements);
  }
  return batch;
}

void BakePilot::grow(std::size_t rays) {
  int fewest = quantities_.front().rays;
  for (const PilotQuantity& quantity : quantities_) fewest = std::min(fewest, quantity.rays);
  const std::size_t samples = rays / static_cast<std::size_t>(fewest);
  if (taken_ >= samples || is_complete()) return;
  Batch batch = take(samples - taken_);
  for (const PilotQuantity& quantity : quantities_)
    batch.exact.push_back(
        quantity.exact(batch.samples, batch.placement, placements_, quantity.rays, batch.hash));
  batches_.push_back(std::move(batch));
}

std::vector<Bias> BakePilot::bias(float footprint) {
  std::vector<Bias> out;
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const PilotQuantity& quantity = quantities_[q];
    const TraceSamples trace = quantity.prefiltered(footprint);
    std::vector<BiasUnit> units;
    float largest = 0;
    for (const Batch& batch : batches_) {
      const TracedSamples found =
          trace(batch.samples, batch.placement, placements_, quantity.rays, batch.hash);
      largest = std::max(largest, found.largest);
      const std::uint32_t first = units.empty() ? 0 : units.back().tile + 1;
      for (BiasUnit unit : differences(batch.samples, found, batch.exact[q])) {
        unit.tile += first;
        units.push_back(unit);
      }
    }
    for (BiasUnit& unit : units) unit.difference /= largest > 0 ? largest : 1;
    out.push_back(estimate_bias(std::move(units), 1));
  }
  return out;
}

}  // namespace dapple
