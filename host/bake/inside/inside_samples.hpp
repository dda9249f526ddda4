// Samples that lie inside closed geometry, such as those of a floor below a box. In: samples and
// what was found at them. Out: which of them do not count.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/inside/closed_geometry.hpp"
#include "bake/sample_tracer.hpp"

namespace dapple {

/// 1 for each sample of which all traced sides are inside. Only samples that see little are
/// tested. `placement`: as TraceSamples.
std::vector<std::uint8_t> find_inside_samples(std::span<const SurfaceSample> samples,
                                              std::span<const std::uint32_t> placement,
                                              const Placements& placements,
                                              const TracedSamples& found, ClosedGeometry& closed);

}  // namespace dapple
