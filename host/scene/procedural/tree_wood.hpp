// The trunk and branches around a tree's skeleton. In: the skeleton, at rest or swaying. Out:
// tubes.
#pragma once

#include <cstdint>

#include "scene/procedural/tree_skeleton.hpp"
#include "scene/procedural/tree_sway.hpp"

namespace dapple {

/// Appends one tube for each branch, from its parent's axis to its tip. Thicker branches have more
/// sides. `swaying`: moves the vertices; nullptr for a tree at rest.
void append_wood(Mesh& mesh, const TreeSkeleton& tree, const SwayingSkeleton* swaying,
                 std::uint32_t material);

}  // namespace dapple
