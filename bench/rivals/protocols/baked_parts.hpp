// The parts of a scene whose vertices the protocol "bake" bakes. In: a scene. Out: meshes of some
// triangles and their neighbours, so that the values at the vertices of the triangles are those of
// the whole mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/samples/sample_tracer.hpp"
#include "dapple/scene.hpp"

namespace dapple::bench {

/// Part of a mesh that is baked instead of the mesh: some triangles, and all others at their
/// vertices.
struct BakedPart {
  Mesh mesh;
  std::vector<bool> two_sided;          ///< by triangle
  std::vector<std::uint32_t> compared;  ///< vertices of the chosen triangles
  Placements placements;
};

/// Parts around `triangles` evenly chosen triangles of the scene, or around all if there are fewer.
std::vector<BakedPart> choose_parts(const Scene& scene, std::size_t triangles);

}  // namespace dapple::bench
