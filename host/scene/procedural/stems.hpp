// Blades along stems: how leaflets, needles and leaves stand on what bears them. In: polylines and
// a habit. Out: tubes and blades appended to a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/pcg32.hpp"

namespace dapple {

/// A polyline of two points or more, metres. `up`: unit, the upper side of a frond or branch.
struct Stem {
  std::vector<V3f> points;
  V3f up{0, 1, 0};
};

/// Grows `segments` steps of `length / segments` from `foot`; after each step the direction bends
/// by `bend` (per step) and is normalized.
Stem grow_stem(V3f foot, V3f direction, float length, int segments, V3f bend);

struct BladeHabit {
  float length = 0.1f;      ///< mean, metres
  float width = 0.1f;       ///< of a blade over its length
  float forward = 0.5f;     ///< the blade's direction along its stem; sideways it has 1
  float droop = 0;          ///< downwards
  float wander = 0.1f;      ///< in a random direction
  bool two_ranked = false;  ///< blades stand left and right of the stem, not all around it
};

/// Appends `count` blades, evenly along all stems. The same arguments give the same bits.
void append_blades(Mesh& mesh, const std::vector<Stem>& stems, std::uint32_t count,
                   const BladeHabit& habit, std::uint32_t seed, std::uint32_t material);

/// Appends a tube for each stem, from `radius` at its foot to a point.
void append_stem_tubes(Mesh& mesh, const std::vector<Stem>& stems, float radius, int sides,
                       std::uint32_t material);

}  // namespace dapple
