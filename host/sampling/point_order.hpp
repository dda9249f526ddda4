// An order in which points that are near each other follow one another: their rays are traced
// together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Indices of the points along a Z curve through their box (Morton, "A Computer Oriented Geodetic
/// Data Base", 1966), equals by index.
std::vector<std::uint32_t> order_along_curve(std::span<const V3f> points);

}  // namespace dapple
