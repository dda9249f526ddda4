// Triangles that lie on others, as the backs of cards that are modelled twice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Of each of `triangles` of the mesh, 1 where another one of them has the same three corners, to
/// the bit and in any order, else 0.
std::vector<std::uint8_t> find_coincident(const Mesh& mesh,
                                          std::span<const std::uint32_t> triangles);

}  // namespace dapple
