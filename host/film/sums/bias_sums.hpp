// What a picture's exact rays have shown about its bias so far. In: differences between prefiltered
// and exact rays of samples. Out: sums by layer and pixel.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// Layers in the order of FilmLayout: AO, lights, and the same of backs.
struct BiasSums {
  /// By layer and pixel: prefiltered less exact, summed over the samples that were traced exactly,
  /// each divided by the share of samples that were.
  std::vector<std::vector<float>> differences;
  /// Samples of each pixel that were traced before these sums began; empty: none.
  std::vector<std::uint32_t> earlier;
  double rays = 0, exact_rays = 0;  ///< of all layers
  /// Nodes and primitives that the rays which were traced exactly visited: then, and before.
  double exact_cost = 0, prefiltered_cost = 0;
};

}  // namespace dapple
