// Models of the optical depth of a node along a ray. In: the data that a node stores, and a ray.
// Out: an optical depth, by the renderer's model in scalar form or by an ablation of it.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::bench {

/// The data of a node that models use.
struct NodeOpacity {
  V3f size;                      ///< of the quantized box, metres
  V3f opacity;                   ///< along each axis, [0,1]
  V3f correlation{0.0f};         ///< of the normals' components xy, yz, zx, [-1,1]
  float mass_concentration = 0;  ///< around `mass_pole`, [0,1]
  V3f mass_pole{0.0f};           ///< from the box's centre, in half sizes
};

/// How a model combines the opacities along the axes to one along a direction.
enum class Blend {
  linear,   ///< sum of occluding areas
  areas,    ///< ellipsoid of occluding areas, also for filled boxes
  depths,   ///< ellipsoid of optical depths
  halfway,  ///< the mean of the depths that `areas` and `depths` give
};

/// Whether the optical depth grows with the length of the ray inside the box.
enum class Chord {
  none,
  scaled,     ///< chord_depth(), as in the renderer
  mean_kept,  ///< depth times chord, with larger depths that keep the mean opacity
};

struct DirectionalModel {
  Blend blend;
  Chord chord;
  bool matrix = false;  ///< ellipsoids with off-diagonal terms
  bool centred = true;  ///< rays near the box's centre have a larger depth
};

/// The model of child_optical_depths() in kernels/opacity/footprint.clh.
inline constexpr DirectionalModel kRendererModel{Blend::depths, Chord::scaled, true};

/// Optical depth of the node along a unit direction. `chord` and `middle` as in BoxRay.
float model_depth(const DirectionalModel& model, const NodeOpacity& node, const V3f& direction,
                  float chord, const V3f& middle);

/// Throws Error failed if kRendererModel and the renderer's box_depth() differ.
void check_renderer_model();

}  // namespace dapple::bench
