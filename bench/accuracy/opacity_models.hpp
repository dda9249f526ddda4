// Ways to make an optical depth of what a node stores: the renderer's, in scalar form, and
// the ablations that say what each part of it is worth.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::bench {

/// What a model may know of a node.
struct NodeOpacity {
  V3f size;                      ///< of the grown box, metres
  V3f opacity;                   ///< along each axis, [0,1]
  V3f correlation{0.0f};         ///< of the normals' components xy, yz, zx, [-1,1]
  float mass_concentration = 0;  ///< around the box's centre, [0,1]
};

/// How opacities along the axes become one along a direction.
enum class Blend {
  linear,   ///< occluding areas add up
  areas,    ///< occluding areas as an ellipsoid, however full
  depths,   ///< optical depths as an ellipsoid
  halfway,  ///< the mean of the depths that `areas` and `depths` give
};

/// Whether rays that cross more of the box meet more.
enum class Chord {
  none,
  scaled,     ///< depth times chord, less so as the node fills: the renderer's
  mean_kept,  ///< the same, with depths raised so that the mean opacity stays
};

struct DirectionalModel {
  Blend blend;
  Chord chord;
  bool matrix = false;  ///< ellipsoids with off-diagonal terms
  bool centred = true;  ///< rays that pass the box's centre meet more
};

/// kernels/opacity/footprint.clh's child_optical_depths(), one lane.
inline constexpr DirectionalModel kRendererModel{Blend::depths, Chord::scaled, true};

/// Optical depth of the node along a unit direction for a ray whose chord is `chord` times
/// the mean chord and that passes `off_centre`, as in BoxRay.
float model_depth(const DirectionalModel& model, const NodeOpacity& node, const V3f& direction,
                  float chord, float off_centre);

/// Throws Error failed when kRendererModel and the renderer's box_depth() differ.
void check_renderer_model();

}  // namespace dapple::bench
