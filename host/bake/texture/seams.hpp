// Seams: edges of a smooth surface whose two sides lie at different places of a texture. In: a mesh
// with the texture coordinates of its corners. Out: a texture whose bilinear lookups agree there.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// A bilinear lookup: texels and their weights.
struct Lookup {
  std::array<std::uint32_t, 4> texel{};
  std::array<float, 4> weight{};
};

/// A point of a seam, on its two sides.
struct SeamPoint {
  Lookup a, b;
};

/// Points on the seams of a mesh, two per texel. `corners`: three for each triangle, in [0,1].
/// Edges between triangles that share vertices and are less than 72 degrees apart are smooth; hard
/// edges, and those of more than two triangles, are no seams.
std::vector<SeamPoint> seam_points(const Mesh& mesh, std::span<const V2f> corners,
                                   std::uint32_t size);

/// Changes the values of texels as little as makes both sides of each point nearly equal: Kaczmarz'
/// iteration ("Angenaeherte Aufloesung von Systemen linearer Gleichungen", 1937), as many sweeps as
/// take a step at a seam to a few percent of it.
void join_seams(std::span<const SeamPoint> points, std::vector<float>& texels);
void join_seams(std::span<const SeamPoint> points, std::vector<V3f>& texels);

}  // namespace dapple
