// Vertices at equal positions, by which surfaces are found although exporters split vertices at
// seams of textures and where shading is flat. In: positions. Out: one vertex for each position.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Returns for each vertex the first vertex at its position. Positions are equal if they are on the
/// same point of a grid of 131,072 steps over the surfaces, or, if these are farther from the
/// origin than they are wide, over that distance.
std::vector<std::uint32_t> welded_vertices(std::span<const V3f> positions);

}  // namespace dapple
