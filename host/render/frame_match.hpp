// What in a scene is what in the next frame's scene. In: both scenes, after name_objects() and
// merge_single_instances(). Out: which primitives and placements are the same ones.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Primitives of an object that follow each other in a mesh, in both frames.
struct MatchedPart {
  std::uint32_t mesh = 0, first = 0, count = 0;
  /// Whether the next frame has the same primitives; else what follows has no meaning.
  bool is_there = false;
  std::uint32_t next_mesh = 0;
  /// Added to the index of a vertex, it gives the index in the next frame's mesh.
  std::int64_t vertex_shift = 0;
  bool deforms = false;  ///< some vertex has another position in the next frame's mesh
};

/// Objects are told apart by their names. One whose primitives or placements are not as many in the
/// next frame is not there: what is scaled to zero or loses its area is not in a scene.
struct FrameMatch {
  FrameMatch(const Scene& now, const Scene& next);

  std::vector<MatchedPart> parts;  ///< of all meshes, in order
  std::vector<int> instances;      ///< by instance: its index in the next frame, -1: not there
};

}  // namespace dapple
