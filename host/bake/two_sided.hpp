// Which triangles of a mesh are baked on both sides. In: a scene and BakeSides. Out: a flag for
// each triangle.
#pragma once

#include <vector>

#include "dapple/bake.hpp"

namespace dapple {

/// With BakeSides::automatic those of double-sided materials in small sheets, such as leaves and
/// cards. Grounds and walls have a side that is meant to be seen, though programs write their
/// materials as double-sided: the front.
class TwoSided {
 public:
  /// The scene must outlive the object. Linear in its vertices and instances.
  TwoSided(const Scene& scene, BakeSides sides);
  /// Whether the values of each triangle of `mesh`, which is one of the scene's, describe both
  /// sides.
  [[nodiscard]] std::vector<bool> triangles(const Mesh& mesh) const;

 private:
  const Scene& scene_;
  BakeSides sides_;
  std::vector<float> longest_;  ///< by mesh: diagonal of the largest small sheet, in its units
};

}  // namespace dapple
