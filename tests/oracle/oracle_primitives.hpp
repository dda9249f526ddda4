// The primitives of a scene in world space, and their opacity. In: a scene and rays. Out: triangles
// and curves, and the opacity of each where a ray hits it, in double and without dapple's lookup
// code.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "oracle/embree_oracle.hpp"

namespace dapple::oracle {

/// A triangle in world space, with all that its opacity depends on.
struct Triangle {
  V3f corner[3];
  Imath::V2d uv[3];
  double vertex_alpha[3];
  V3d normal[3];  ///< unit; zeros: the triangle's own
  std::uint32_t material;
};

/// A segment of a strand in world space, in the form of Embree's curves.
struct Curve {
  V3f end[2];
  float radius[2];
  double vertex_alpha;  ///< mean of the two ends
  std::uint32_t material;
  bool goes_on;  ///< the next segment begins where this one ends
};

/// Barycentric weights of the three corners at the point where a line hits the triangle's plane.
struct Weights {
  double of[3];
};

V3d normal_of(const Triangle& triangle);

/// The weights at the point where the line hits the triangle's plane.
Weights weights_at(const Triangle& triangle, const V3d& origin, const V3d& direction);

template <class Value>
Value interpolate(const Weights& weights, const Value (&values)[3]) {
  return values[0] * weights.of[0] + values[1] * weights.of[1] + values[2] * weights.of[2];
}

/// All primitives of a scene. Instances of strands must scale uniformly.
struct Primitives {
  std::vector<Triangle> triangles;
  std::vector<Curve> curves;
  std::vector<Material> materials;
  std::vector<Texture> textures;

  explicit Primitives(const Scene& scene);

  /// Opacity of a primitive where the segment hits it. Primitives: all triangles, then all curves.
  [[nodiscard]] double opacity(unsigned primitive, const Segment& segment) const;
};

}  // namespace dapple::oracle
