#include "accuracy/opacity_models.hpp"

#include <algorithm>
#include <cmath>

#include "accuracy/box_rays.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "dapple/error.hpp"
#include "dapple/shared/opacity.h"

namespace dapple::bench {
namespace {

float sum(const V3f& v) { return v.x + v.y + v.z; }

/// Value of an ellipsoid along a direction: the length of `terms`, its parts >= 0 along the axes,
/// with off-diagonal terms from the correlations of the normals. SGGX: Heitz et al., "The SGGX
/// Microflake Distribution", 2015.
float ellipsoid(const V3f& terms, const V3f& direction, const V3f& correlation) {
  V3f v = terms;
  for (int axis = 0; axis < 3; ++axis) v[axis] = std::copysign(terms[axis], direction[axis]);
  const float crossed =
      correlation.x * v.x * v.y + correlation.y * v.y * v.z + correlation.z * v.z * v.x;
  return std::sqrt(std::max(0.0f, v.length2() + 2.0f * crossed));
}

float depth_with_chord(float depth, Chord chord, float length, const V3f& facing) {
  if (chord == Chord::none) return depth;
  const float counted = std::max(length, 0.0f);
  if (chord == Chord::scaled) return chord_depth(depth, counted);
  // Chords are modelled by a gamma distribution of variance v: the mean of exp(-raised * chord) is
  // (1 + v raised)^(-1/v). `raised` makes this mean equal to exp(-depth).
  const float variance = chord_variance(facing);
  const float raised = variance > 1e-4f ? std::expm1(variance * depth) / variance : depth;
  return raised * counted;
}

}  // namespace

float model_depth(const DirectionalModel& model, const NodeOpacity& node, const V3f& direction,
                  float chord, const V3f& middle) {
  const V3f faces = facing_areas(node.size, direction);
  const float inverse = 1.0f / (sum(faces) + 1e-37f);
  const V3f area = node.opacity * faces;
  const V3f correlation = model.matrix ? node.correlation : V3f(0.0f);
  const float silhouette = ellipsoid(area, direction, correlation) * inverse;
  const float weight =
      model.centred ? centre_weight(node.mass_concentration, (middle - node.mass_pole).length2(),
                                    node.mass_pole.length2())
                    : 1.0f;
  const auto with_chord = [&](float depth) {
    return weight * depth_with_chord(depth, model.chord, chord, faces);
  };
  if (model.blend == Blend::linear) return with_chord(depth_of(sum(area) * inverse));
  if (model.blend == Blend::areas) return with_chord(depth_of(silhouette));
  const V3f depths(depth_of(node.opacity.x), depth_of(node.opacity.y), depth_of(node.opacity.z));
  const float depth = ellipsoid(depths * faces, direction, correlation) * inverse;
  const bool halfway = model.blend == Blend::halfway;
  return with_chord(halfway ? 0.5f * (depth + depth_of(silhouette)) : depth);
}

void check_renderer_model() {
  const V3f direction = V3f(0.3f, -0.5f, 0.8f).normalized(), correlation(0.2f, -0.4f, 0.6f);
  for (const float x : {0.02f, 0.3f, 0.7f, 0.99f}) {
    for (const float y : {0.02f, 0.3f, 0.7f, 0.99f}) {
      const NodeOpacity node{V3f(1, 2, 3), V3f(x, y, 0.6f), correlation};
      const V3f faces = facing_areas(node.size, direction);
      const float here = model_depth(kRendererModel, node, direction, 1.0f, V3f(0.0f));
      const float there = box_depth(depth_of(x), depth_of(y), depth_of(0.6f), -correlation.x,
                                    -correlation.y, correlation.z, faces.x, faces.y, faces.z);
      if (std::fabs(here - there) > 1e-4f * (1.0f + there))
        throw Error(ErrorKind::failed,
                    "bench/accuracy/opacity_models.cpp is out of step with box_depth() of "
                    "dapple/shared/opacity.h: change model_depth()");
    }
  }
}

}  // namespace dapple::bench
