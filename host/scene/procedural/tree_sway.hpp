// A tree in the wind: limbs bend along their length, leaves flutter. In: a skeleton at rest, a wind
// and a time; out: where each of its nodes carries what is around it. Smooth in time and in space,
// and a function of both alone: any frame may be made without those before it.
#pragma once

#include <Imath/ImathQuat.h>

#include <vector>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/tree_skeleton.hpp"

namespace dapple {

/// Blows along +X.
struct Wind {
  double strength = 0;  ///< 0: calm, 1: branches toss
  double seconds = 0;

  [[nodiscard]] bool blows() const { return strength > 0; }
};

class SwayingSkeleton {
 public:
  /// Refers to `rest`. The trunk's foot stays where it is.
  SwayingSkeleton(const TreeSkeleton& rest, float height_m, const Wind& wind);

  /// Where a point goes that is at `rest` while `node` is at rest.
  [[nodiscard]] V3f moved(std::uint32_t node, V3f rest) const;
  /// The same of a unit direction.
  [[nodiscard]] V3f turned(std::uint32_t node, V3f rest) const;

 private:
  const TreeSkeleton& rest_;
  std::vector<Imath::V3d> positions_;
  std::vector<Imath::Quatd> tickets_;
};

/// A leaf, where its twig carries it, turned about its axis and nodding, each in its own way.
Blade flutter(const Blade& blade, const Wind& wind, std::uint32_t seed, std::uint32_t leaf);

}  // namespace dapple
