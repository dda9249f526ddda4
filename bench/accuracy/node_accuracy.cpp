#include "accuracy/node_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "accuracy/box_rays.hpp"
#include "accuracy/composition.hpp"
#include "accuracy/opacity_models.hpp"
#include "accuracy/strand_truth.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "dapple/shared/opacity.h"

namespace dapple::bench {
namespace {

/// Subtrees of one triangle, and of [n, 2n) for the others.
constexpr std::size_t kSizes[] = {1, 2, 4, 16, 64, 256, 1024, 4096, 16384, 65536};

/// The true opacities along axes are sampled with kAxisRays times the rays of a direction.
constexpr int kAxisRays = 4;

/// The data of a node for the different models.
struct JudgedNode {
  Box3f box;           ///< the quantized box, which is larger than the exact one
  NodeOpacity stored;  ///< the data that the kernels read
  V3f exact_box;       ///< opacities relative to the exact box
  V3f rectangles;      ///< Composition::rectangles
  V3f true_axes;       ///< sampled along the axes; with these only the directional error remains
};

struct Model {
  const char* name;
  DirectionalModel directional;
  V3f JudgedNode::*opacity = nullptr;  ///< replaces the stored opacities, unless nullptr
};

/// Most of them change one part of the first model.
constexpr Model kModels[] = {
    {"renderer", kRendererModel},
    {"no chord", {Blend::depths, Chord::none, true}},
    {"chord, mean kept", {Blend::depths, Chord::mean_kept, true}},
    {"no centre", {Blend::depths, Chord::scaled, true, false}},
    {"no matrix", {Blend::depths, Chord::scaled, false}},
    {"linear", {Blend::linear, Chord::scaled}},
    {"areas", {Blend::areas, Chord::scaled, true}},
    {"halfway", {Blend::halfway, Chord::scaled, true}},
    {"halfway, mean kept", {Blend::halfway, Chord::mean_kept, true}},
    {"growth ignored", kRendererModel, &JudgedNode::exact_box},
    {"rectangles", kRendererModel, &JudgedNode::rectangles},
    {"true axes", kRendererModel, &JudgedNode::true_axes},
    {"rectangles, linear, no chord", {Blend::linear, Chord::none}, &JudgedNode::rectangles},
};
constexpr std::size_t kModelCount = std::size(kModels);

V3f unit_axis(int axis) {
  V3f direction(0.0f);
  direction[axis] = 1.0f;
  return direction;
}

Box3f bounds_of(const std::vector<LeafTriangle>& triangles,
                const std::vector<StrandSegment>& segments) {
  Box3f box;
  for (const StrandSegment& segment : segments) box.extendBy(bounds(segment));
  for (const LeafTriangle& triangle : triangles) {
    box.extendBy(triangle.vertex);
    box.extendBy(triangle.vertex + triangle.edge1);
    box.extendBy(triangle.vertex + triangle.edge2);
  }
  return box;
}

/// The stored opacities, relative to the exact box instead of the larger quantized box.
V3f before_growing(const V3f& opacity, const V3f& grown, const V3f& exact) {
  V3f out;
  for (int axis = 0; axis < 3; ++axis) {
    const V3f along = unit_axis(axis);
    const float area = facing_areas(exact, along)[axis];
    const float ratio = area > 0.0f ? facing_areas(grown, along)[axis] / area : 1.0f;
    out[axis] = std::min(1.0f, opacity[axis] * ratio);
  }
  return out;
}

/// Mean opacity that a model computes for the rays of the truth.
double model_opacity(const Model& model, const JudgedNode& node, const V3f& direction,
                     const std::vector<BoxRay>& rays) {
  NodeOpacity known = node.stored;
  if (model.opacity) known.opacity = node.*model.opacity;
  double opacity = 0;
  for (const BoxRay& ray : rays)
    opacity +=
        1 - std::exp(-model_depth(model.directional, known, direction, ray.chord, ray.middle));
  return opacity / static_cast<double>(rays.size());
}

/// Sums over the subtrees of one size.
class ErrorSums {
 public:
  void add(const JudgedNode& node, const V3f& direction, const SampledOpacity& truth) {
    ++count_;
    truth_ += truth.opacity;
    noise_ += truth.variance;
    for (std::size_t m = 0; m < kModelCount; ++m) {
      const double error = model_opacity(kModels[m], node, direction, truth.rays) - truth.opacity;
      errors_[m] += error;
      squares_[m] += error * error;
    }
  }

  void finish(NodeAccuracyRow& row) const {
    row.true_opacity = truth_ / count_;
    for (std::size_t m = 0; m < kModelCount; ++m) {
      const double bias = errors_[m] / count_;
      // The estimate without noise is noisy itself. It is never below the bias.
      const double square = std::max(bias * bias, (squares_[m] - noise_) / count_);
      row.errors.push_back({bias, std::sqrt(square)});
    }
  }

 private:
  double count_ = 0, truth_ = 0, noise_ = 0;
  double errors_[kModelCount] = {}, squares_[kModelCount] = {};
};

class NodeJudge {
 public:
  NodeJudge(const Scene& scene, const SceneBvh& bvh, const NodeAccuracyOptions& options)
      : scene_(scene),
        bvh_(bvh),
        options_(options),
        compositions_(compose(bvh, scene)),
        random_(options.seed) {}

  /// Measures at most options.nodes of the candidates, which are chosen at random.
  NodeAccuracyRow judge(std::vector<Subtree> candidates, std::size_t triangles) {
    const std::size_t count = std::min(candidates.size(), static_cast<std::size_t>(options_.nodes));
    ErrorSums sums;
    for (std::size_t i = 0; i < count; ++i) {
      std::swap(candidates[i], candidates[i + random_.bits() % (candidates.size() - i)]);
      judge_one(candidates[i], sums);
    }
    NodeAccuracyRow row;
    row.triangles = triangles;
    row.nodes = static_cast<int>(count);
    sums.finish(row);
    return row;
  }

 private:
  void judge_one(const Subtree& subtree, ErrorSums& sums) {
    const BvhNode& node = bvh_.nodes[subtree.node];
    if (node.prim_base & DAPPLE_SEGMENTS) {
      const auto segments = segments_below(bvh_, node, subtree.slot);
      const StrandTruth truth(segments);
      judge_by([&](const auto& ray) { return truth.transmittance(ray); }, bounds_of({}, segments),
               subtree, sums);
    } else {
      const auto triangles = triangles_below(bvh_, node, subtree.slot);
      const oracle::EmbreeOracle truth(scene_of(triangles, bvh_, scene_));
      judge_by([&](const auto& ray) { return truth.transmittance(ray); }, bounds_of(triangles, {}),
               subtree, sums);
    }
  }

  void judge_by(const Truth& truth, const Box3f& exact, const Subtree& subtree, ErrorSums& sums) {
    const JudgedNode judged = describe(subtree, exact, truth);
    for (int d = 0; d < options_.directions; ++d) {
      const V3f direction(random_.direction());
      sums.add(judged, direction,
               sample_opacity(truth, judged.box, direction, options_.rays, random_));
    }
  }

  JudgedNode describe(const Subtree& subtree, const Box3f& exact, const Truth& truth) {
    const BvhNode& node = bvh_.nodes[subtree.node];
    const Composition& composition = compositions_[subtree.node][subtree.slot];
    JudgedNode judged;
    judged.box = child_box(node, subtree.slot);
    judged.stored.size = judged.box.size();
    judged.stored.mass_concentration = bvh_mass_concentration(node.leaf_end, subtree.slot);
    judged.rectangles = composition.rectangles;
    for (int axis = 0; axis < 3; ++axis) {
      judged.stored.opacity[axis] = 1.0f - std::exp(-decode_depth(node.depth[axis][subtree.slot]));
      judged.stored.mass_pole[axis] =
          bvh_mass_pole(node.correlation, static_cast<uint>(axis), subtree.slot);
      judged.stored.correlation[axis] = decode_correlation(node.correlation[axis][subtree.slot]);
      judged.true_axes[axis] = static_cast<float>(
          sample_opacity(truth, judged.box, unit_axis(axis), kAxisRays * options_.rays, random_)
              .opacity);
    }
    judged.exact_box = before_growing(judged.stored.opacity, judged.stored.size, exact.size());
    return judged;
  }

  const Scene& scene_;
  const SceneBvh& bvh_;
  const NodeAccuracyOptions& options_;
  Compositions compositions_;
  oracle::Random random_;
};

}  // namespace

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const Model& model : kModels) names.emplace_back(model.name);
  return names;
}

std::vector<NodeAccuracyRow> measure_nodes(const Scene& scene, const SceneBvh& bvh,
                                           const NodeAccuracyOptions& options) {
  check_renderer_model();
  NodeJudge judge(scene, bvh, options);
  const std::vector<Subtree> all = list_subtrees(bvh);
  std::vector<NodeAccuracyRow> rows;
  for (const std::size_t size : kSizes) {
    std::vector<Subtree> candidates;
    // Rays do not stop at walls, which store no depth.
    std::copy_if(all.begin(), all.end(), std::back_inserter(candidates), [&](const Subtree& s) {
      return s.triangles >= size && s.triangles < 2 * size &&
             !bvh_is_wall(bvh.nodes[s.node].depth, s.slot);
    });
    if (!candidates.empty()) rows.push_back(judge.judge(std::move(candidates), size));
  }
  return rows;
}

}  // namespace dapple::bench
