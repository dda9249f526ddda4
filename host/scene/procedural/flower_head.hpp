// A flower head as daisies have it: a dome of florets in two whorls of petals, over a cup of
// bracts. In: a place, sizes and counts. Out: smooth, coloured triangles appended to a mesh.
#pragma once

#include <vector>

#include "scene/procedural/lamina.hpp"
#include "scene/procedural/pcg32.hpp"

namespace dapple {

/// Indices of materials in a scene of flowers.
struct FlowerMaterials {
  std::uint32_t petal = 0, floret = 1, leaf = 2, stem = 3, ground = 4;
};

struct FlowerHead {
  V3f centre;              ///< of the disc of florets, where it meets the petals
  V3f axis;                ///< unit, where the head looks
  float disc_radius = 0;   ///< metres, of the florets' dome
  float petal_length = 0;  ///< metres
  float openness = 1;      ///< 1: petals spread, 0: upright
  float shade = 0;         ///< in [0, 1], from deep rose to pale pink
};

struct FlowerCounts {
  int petals = 21, florets = 200;
  int detail = 8;  ///< columns of a petal
};

void append_flower_head(Mesh& mesh, const FlowerHead& head, const FlowerCounts& counts,
                        const FlowerMaterials& materials, Pcg32& rng);

/// Appends a tube through `points`, from a stem's foot to a head. Below the head it widens to carry
/// the petals. `radius` and `head_radius`, of the disc of florets, are metres.
void append_flower_stem(Mesh& mesh, const std::vector<V3f>& points, float radius, float head_radius,
                        std::uint32_t material);

}  // namespace dapple
