// Segments of strands with the planes that end them. In: a mesh of strands. Out: the segments that
// blocks store, and that are decoded from blocks.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The side of a cone between two planes; dapple/shared/segment_block.h says what rays make of it.
struct StrandSegment {
  std::array<V3f, 2> point;  ///< ends of the axis
  std::array<V3f, 2> plane;  ///< normals, of any length, towards the end
  std::array<float, 2> radius{0, 0};
  std::array<bool, 2> cap{false, false};  ///< where a strand begins or ends
  float opacity = 0;                      ///< [0,1]
};

/// Around the part of the cone between the planes.
Box3f bounds(const StrandSegment& segment);

/// The joints of strands: vertices that two segments share.
class StrandJoints {
 public:
  explicit StrandJoints(const Mesh& mesh);

  /// Segment `index` of the mesh; its opacity is left to the caller. Where its strand goes on, the
  /// plane halves the angle; where it turns back sharply, branches or flares, it is cut across.
  [[nodiscard]] StrandSegment segment(const Mesh& mesh, std::uint32_t index) const;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kMany = kNone - 1;

  /// The other segment at `index`'s end, kNone or kMany.
  [[nodiscard]] std::uint32_t neighbour(const Mesh& mesh, std::uint32_t index, int end) const;

  std::vector<std::array<std::uint32_t, 2>> at_vertex_;  ///< the segments there
};

}  // namespace dapple
