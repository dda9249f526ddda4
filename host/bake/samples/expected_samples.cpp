#include "bake/samples/expected_samples.hpp"

#include <algorithm>
#include <vector>

#include "bake/instance_bake.hpp"
#include "bake/mesh_placements.hpp"
#include "bake/samples/surface_samples.hpp"

namespace dapple {
namespace {

/// Samples of a triangle that a target needs in the mean, for the first guess of the time left.
constexpr double kExpectedSamples = 4;

/// Share of a texture that triangles cover, for the same guess.
constexpr double kExpectedCoverage = 0.5;

}  // namespace

double expected_samples(const Scene& scene, const BakeOptions& options) {
  const std::vector<std::size_t> counts = placement_counts(scene, options.placement);
  const auto of_element = [&](std::size_t placements, bool at_vertex) {
    return options.target_error > 0
               ? kExpectedSamples
               : double{1.0 * sample_counts(options.rays, placements, at_vertex).samples};
  };
  double samples = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size() && options.vertices; ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.has_strands()) continue;
    const std::size_t elements =
        options.at_vertices ? mesh.positions.size() : mesh.primitive_count();
    samples += static_cast<double>(elements) * of_element(counts[m], options.at_vertices);
  }
  if (options.texture && !counts.empty()) {
    const std::size_t most = *std::max_element(counts.begin(), counts.end());
    samples +=
        kExpectedCoverage * of_element(most, false) * options.texture_size * options.texture_size;
  }
  if (options.instances)
    samples += static_cast<double>(scene.instances.size()) *
               (options.target_error > 0 ? 1.0 * kExpectedRounds * kInstanceRound
                                         : 1.0 * options.rays / kRaysPerSample);
  return options.light ? 2 * samples : samples;
}

}  // namespace dapple
