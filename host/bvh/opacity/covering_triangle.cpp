#include "bvh/opacity/covering_triangle.hpp"

#include <cmath>

namespace dapple {
namespace {

/// Two triangles that share an edge.
struct Joint {
  unsigned axes = 0;  ///< bit k is set if they lie on opposite sides of it, seen along axis k
  int corner_a = 0, corner_b = 0;  ///< those opposite to the edge
};

using Four = float __attribute__((vector_size(16)));
using FourInts = int __attribute__((vector_size(16)));

/// The corners of a triangle, by axis. Lane 3 is not used.
struct Corners {
  Four axis[3];
  float tolerance;  ///< corners that were equal differ by less: stored edges are rounded

  Corners() = default;
  explicit Corners(const CoveringTriangle& t) : tolerance(0) {
    for (int k = 0; k < 3; ++k) {
      axis[k] = Four{0, t.edge1[k], t.edge2[k], 0} + t.vertex[k];
      tolerance += 1e-5f * (std::fabs(t.edge1[k]) + std::fabs(t.edge2[k]));
    }
  }
  [[nodiscard]] V3f operator[](int corner) const {
    return {axis[0][corner], axis[1][corner], axis[2][corner]};
  }
};

/// Lane i is -1 if corner i of `a` equals corner (i + kFirst) % 3 of `b`, else 0. Lane 3 has no
/// meaning.
template <int kFirst>
FourInts equal_corners(const Corners& a, const Corners& b) {
  FourInts equal{-1, -1, -1, -1};
  for (int k = 0; k < 3; ++k) {
    const Four other = __builtin_shufflevector(b.axis[k], b.axis[k], kFirst, (kFirst + 1) % 3,
                                               (kFirst + 2) % 3, 3);
    const Four difference = a.axis[k] - other;
    equal &= (difference <= a.tolerance) & (difference >= -a.tolerance);
  }
  return equal;
}

Joint joint_of(const Corners& p, const Corners& q) {
  const FourInts equal[3] = {equal_corners<0>(p, q), equal_corners<1>(p, q),
                             equal_corners<2>(p, q)};
  const FourInts found = equal[0] + equal[1] + equal[2];
  if (found[0] + found[1] + found[2] > -2) return {};
  int shared[2][2] = {}, count = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (count < 2 && equal[(j - i + 3) % 3][i]) {
        shared[count][0] = i;
        shared[count++][1] = j;
      }
    }
  }
  if (shared[0][0] == shared[1][0] || shared[0][1] == shared[1][1]) return {};
  Joint joint;
  joint.corner_a = 3 - shared[0][0] - shared[1][0];
  joint.corner_b = 3 - shared[0][1] - shared[1][1];
  const V3f& from = p[shared[0][0]];
  const V3f edge = p[shared[1][0]] - from;
  const V3f third_a = p[joint.corner_a] - from, third_b = q[joint.corner_b] - from;
  const V3f turn_a = edge.cross(third_a), turn_b = edge.cross(third_b);
  for (int axis = 0; axis < 3; ++axis)
    joint.axes |= unsigned{turn_a[axis] * turn_b[axis] < 0.0f} << axis;
  return joint;
}

bool have_same_opacity(const CoveringTriangle& a, const CoveringTriangle& b) {
  return a.opacity >= 0.0f && a.opacity == b.opacity && !a.closed && !b.closed;
}

}  // namespace

SharedEdges::SharedEdges(const Covering& covering) : count_(covering[0].size()) {
  const bool alike = covering[0].data() == covering[1].data();
  for (int axis = 0; axis < (alike ? 1 : 3); ++axis)
    compare(covering[axis], alike ? 7u : 1u << axis);
}

void SharedEdges::compare(std::span<const CoveringTriangle> triangles, unsigned axes) {
  std::array<Corners, kMaxCovering> corners;
  for (std::size_t b = 0; b < triangles.size(); ++b) {
    corners[b] = Corners(triangles[b]);
    for (std::size_t a = 0; a < b; ++a) {
      const Joint joint = joint_of(corners[a], corners[b]);
      if (joint.axes == 0) continue;
      const bool pairs = have_same_opacity(triangles[a], triangles[b]);
      for (int axis = 0; axis < 3; ++axis) {
        if (!(axes & joint.axes & 1u << axis)) continue;
        auto& neighbours = neighbours_[axis];
        neighbours[a] = static_cast<std::uint16_t>(neighbours[a] | 1u << b);
        neighbours[b] = static_cast<std::uint16_t>(neighbours[b] | 1u << a);
        auto& partners = partners_[axis];
        if (!pairs || partners[a].triangle >= 0 || partners[b].triangle >= 0) continue;
        partners[a] = {static_cast<std::int8_t>(b), static_cast<std::int8_t>(joint.corner_a)};
        partners[b] = {static_cast<std::int8_t>(a), static_cast<std::int8_t>(joint.corner_b)};
      }
    }
  }
}

bool SharedEdges::is_single_layer() const {
  for (const auto& neighbours : neighbours_) {
    for (std::size_t t = 1; t < count_; ++t) {
      if (!(neighbours[t] & ((1u << t) - 1u))) return false;
    }
  }
  return true;
}

CoveringTriangle turned(const CoveringTriangle& triangle, int corner) {
  CoveringTriangle out = triangle;
  const V3f between = triangle.edge2 - triangle.edge1;
  if (corner == 1) {
    out.vertex += triangle.edge1;
    out.edge1 = between;
    out.edge2 = -triangle.edge1;
  } else if (corner == 2) {
    out.vertex += triangle.edge2;
    out.edge1 = -triangle.edge2;
    out.edge2 = -between;
  }
  return out;
}

}  // namespace dapple
