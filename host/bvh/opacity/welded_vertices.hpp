// Vertices at equal positions, by which surfaces are found although exporters split vertices at
// seams of textures and where shading is flat. In: positions. Out: one vertex for each position.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Returns for each vertex the first vertex at its position. Positions are equal if they are on the
/// same point of a grid of 2^17 steps over the surfaces, or, if these are farther from the origin
/// than they are wide, over that distance; of up to 2^22 steps where more than a twentieth of the
/// triangles would be smaller than two steps. `indices`: three for each triangle.
std::vector<std::uint32_t> welded_vertices(std::span<const V3f> positions,
                                           std::span<const std::uint32_t> indices);

}  // namespace dapple
