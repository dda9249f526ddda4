// Finds triangles that coincide with others, such as both sides of a card that is modelled with two
// triangles. In: triangles of a mesh. Out: which of them coincide.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Returns, for each of `triangles`, 1 if another one of them has exactly the same three corners,
/// in any order, else 0.
std::vector<std::uint8_t> find_coincident(const Mesh& mesh,
                                          std::span<const std::uint32_t> triangles);

}  // namespace dapple
