// Notes that the options of measure_points() may not do what was meant. In: options, the scene
// without its ground and copies, and the points. Out: one sentence for each.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dapple/points.hpp"

namespace dapple {

std::vector<std::string> option_notes(const PointOptions& options, const Scene& scene,
                                      std::span<const V3f> points);

}  // namespace dapple
