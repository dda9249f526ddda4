// Shading normals of one triangle. In: a mesh. Out: the normals of the triangle's corners, as the
// shading pass and bakes use them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "dapple/scene.hpp"

namespace dapple {

/// Unit normals of a triangle's corners, turned to the side of its face's normal, as the corners
/// are ordered; corners without a normal get that of the face. Nothing for a flat triangle: the
/// mesh has no normals, or all are those of the face, to 0.1 degrees.
std::optional<std::array<V3f, 3>> corner_normals(const Mesh& mesh, std::size_t triangle);

/// Whether any triangle of the scene has corner_normals().
bool is_smooth(const Scene& scene);

}  // namespace dapple
