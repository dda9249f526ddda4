// Measures the bias of a bake before its samples are taken. In: meshes with their placements, and
// functions that trace samples. Out: the bias of AO and light for any footprint.
#pragma once

#include <functional>
#include <vector>

#include "bake/bake_bias.hpp"
#include "bake/two_sided.hpp"
#include "sampling/footprint_choice.hpp"

namespace dapple {

/// A mesh whose values are baked.
struct PilotMesh {
  /// `options`: only which normals its samples have.
  PilotMesh(const Mesh& of, const TwoSided& sides, const BakeOptions& options, Placements given);
  const Mesh* mesh;
  VertexGroups groups;          ///< one for all vertices, since no value is made
  std::vector<bool> two_sided;  ///< by triangle
  Normals normals;
  Placements placements;
};

/// A quantity: how to trace it exactly, and with a footprint.
struct PilotQuantity {
  int rays = 0;  ///< of a sample
  TraceSamples exact;
  std::function<TraceSamples(float footprint)> prefiltered;
};

class BakePilot : public BiasSource {
 public:
  BakePilot(const std::vector<PilotMesh>& meshes, std::vector<PilotQuantity> quantities,
            std::uint32_t seed);

  void grow(std::size_t rays) override;
  [[nodiscard]] bool is_complete() const override { return taken_ >= most_; }
  std::vector<Bias> bias(float footprint) override;

 private:
  /// Samples that were taken at once, and what was found exactly, by quantity.
  struct Batch {
    std::vector<SurfaceSample> samples;
    std::vector<std::uint32_t> placement;
    std::vector<TracedSamples> exact;
    std::uint32_t hash = 0;
  };

  [[nodiscard]] Batch take(std::size_t count);

  const std::vector<PilotMesh>& meshes_;
  std::vector<PilotQuantity> quantities_;
  std::uint32_t seed_;
  Placements placements_;                        ///< of all meshes, one after the other
  std::vector<std::uint32_t> first_placement_;   ///< by mesh
  std::vector<std::uint64_t> triangles_before_;  ///< by mesh, and of all
  std::size_t taken_ = 0, most_ = 0;             ///< samples
  std::vector<Batch> batches_;
};

}  // namespace dapple
