// A tree in the wind: limbs bend along their length, leaves flutter. In: a skeleton at rest, a wind
// and a time; out: how each node moves and turns the points around it. The motion is smooth in time
// and space and depends on nothing else, so that each frame can be made without earlier frames.
#pragma once

#include <Imath/ImathQuat.h>

#include <vector>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/tree_skeleton.hpp"

namespace dapple {

/// Wind along +X.
struct Wind {
  double strength = 0;  ///< 0: calm, 1: branches move strongly
  double seconds = 0;

  [[nodiscard]] bool blows() const { return strength > 0; }
};

class SwayingSkeleton {
 public:
  /// Keeps a reference to `rest`, which must outlive this. The trunk's foot does not move.
  SwayingSkeleton(const TreeSkeleton& rest, float height_m, const Wind& wind);

  /// The moved position of a point that is attached to `node` and is at `rest` when the tree is.
  [[nodiscard]] V3f moved(std::uint32_t node, V3f rest) const;
  /// The same for a unit direction.
  [[nodiscard]] V3f turned(std::uint32_t node, V3f rest) const;

 private:
  const TreeSkeleton& rest_;
  std::vector<Imath::V3d> positions_;
  std::vector<Imath::Quatd> rotations_;
};

/// Turns a leaf that its twig has already moved: about its axis and up and down, with frequencies
/// and phases that depend on `seed` and `leaf`.
Blade flutter(const Blade& blade, const Wind& wind, std::uint32_t seed, std::uint32_t leaf);

}  // namespace dapple
