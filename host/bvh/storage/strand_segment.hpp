// Segments of strands with the planes at their ends. In: a mesh of strands. Out: segments, as they
// are stored in blocks and decoded from blocks.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The lateral surface of a cone between two planes; dapple/shared/segment_block.h describes how
/// rays intersect it.
struct StrandSegment {
  std::array<V3f, 2> point;  ///< ends of the axis
  std::array<V3f, 2> plane;  ///< normals, of any length, towards the end
  std::array<float, 2> radius{0, 0};
  std::array<bool, 2> cap{false, false};  ///< whether the strand begins or ends at this end
  float opacity = 0;                      ///< [0,1]
};

/// Returns the box around the part of the cone between the planes.
Box3f bounds(const StrandSegment& segment);

/// The joints of strands: vertices that two segments share.
class StrandJoints {
 public:
  explicit StrandJoints(const Mesh& mesh);

  /// Returns segment `index` of the mesh; the caller sets its opacity. If the strand continues at
  /// an end, the plane there halves the angle between both segments. If the strand turns back
  /// sharply, branches or changes its radius fast, the plane is perpendicular to the axis.
  [[nodiscard]] StrandSegment segment(const Mesh& mesh, std::uint32_t index) const;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kMany = kNone - 1;

  /// Returns the other segment at this end of segment `index`, kNone or kMany.
  [[nodiscard]] std::uint32_t neighbour(const Mesh& mesh, std::uint32_t index, int end) const;

  std::vector<std::array<std::uint32_t, 2>> at_vertex_;  ///< segments at each vertex
};

}  // namespace dapple
