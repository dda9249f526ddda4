// Quantizes the opacity of a child: depths along the axes, correlations, mass and variance, in the
// bytes that dapple/shared/bvh_node.h lays out and dapple/shared/opacity.h decodes. In: the opacity
// of the child's exact box. Out: bytes of its node.
#pragma once

#include "bvh/opacity/node_opacity.hpp"
#include "bvh/refit/refit_record.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

/// Stores the opacity of child `slot`. `opacity` is that of its `exact` box; it is converted to its
/// quantized box, which is larger. Returns the clumping_factor() of the child.
float set_child_opacity(BvhNode& node, unsigned slot, const NodeOpacity& opacity,
                        const Box3f& exact);

/// Returns the variance_class() that is stored with the opacity of child `slot`.
unsigned variance_of_child(const BvhNode& node, unsigned slot);

/// Sets the opacity of child `slot` after motion, from the record's `kept` opacity of the node's
/// children. `areas` and `normals` are those of the surfaces that the child's `exact` box contains
/// now.
void set_kept_opacity(BvhNode& node, unsigned slot, const KeptOpacity& kept,
                      const SurfaceAreas& areas, const NormalMoments& normals, const Box3f& exact);

}  // namespace dapple
