#include "bvh/build/top_level.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "bvh/opacity/quantize_opacity.hpp"
#include "dapple/error.hpp"
#include "scene/check/finite.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

double matrix_scale(const M44f& m) {
  const V3f x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]),
      z(m[2][0], m[2][1], m[2][2]);
  return std::fabs(static_cast<double>(x.dot(y.cross(z))));
}

/// Rows of a 3x4 matrix for column vectors from Imath's 4x4 for row vectors.
void store_rows(const M44f& m, float (&rows)[12]) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) rows[4 * row + column] = m[column][row];
  }
}

/// Returns the world box around the boxes of the root's children. It is tighter than the world box
/// around the root's box. Of each sum for a corner the least and the largest terms are added up
/// (Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems, 1990).
Box3f world_box(const std::vector<Box3f>& parts, const M44f& to_world) {
  Box3f world;
  for (const Box3f& box : parts) {
    if (box.isEmpty()) continue;
    V3f low(0.0f), high(0.0f);
    for (int from = 0; from < 3; ++from) {
      for (int axis = 0; axis < 3; ++axis) {
        const float a = box.min[from] * to_world[from][axis];
        const float b = box.max[from] * to_world[from][axis];
        low[axis] += std::min(a, b);
        high[axis] += std::max(a, b);
      }
    }
    const V3f origin(to_world[3][0], to_world[3][1], to_world[3][2]);
    world.extendBy(Box3f(low + origin, high + origin));
  }
  return world;
}

/// Returns where the mass of the object is in the instance's world box. Its pole is moved to the
/// new place of the centroid.
MassShape placed_mass(const ObjectSummary& object, const M44f& to_world, const Box3f& world) {
  MassShape mass = object.opacity.mass;
  if (!(mass.concentration > 0.0f)) return mass;
  const V3f half = (object.box.max - object.box.min) * 0.5f;
  const V3f centroid = (object.box.center() + half * mass.centroid()) * to_world - world.center();
  for (int axis = 0; axis < 3; ++axis) {
    const float size = 0.5f * (world.max[axis] - world.min[axis]);
    const float place = size > 0.0f ? centroid[axis] / size : 0.0f;
    mass.pole[axis] = std::clamp(1.5f * place / mass.concentration, -0.75f, 0.75f);
  }
  return mass;
}

/// Returns the opacity of the instance's world box, from that of the object's root. A ray along the
/// world axis e crosses the object in direction M^-1 e, and projected areas grow by
/// |det M| |M^-1 e|.
NodeOpacity instance_opacity(const ObjectSummary& object, const M44f& to_world,
                             const Box3f& world) {
  const M44f to_object = to_world.inverse();
  const V3f size = object.box.max - object.box.min;
  NodeOpacity opacity;
  opacity.normals = object.opacity.normals.placed(to_world);
  opacity.clumping = object.opacity.clumping;
  opacity.mass = placed_mass(object, to_world, world);
  opacity.wall = object.opacity.wall;
  for (int axis = 0; axis < 3; ++axis) {
    V3f world_axis(0.0f), direction;
    world_axis[axis] = 1.0f;
    to_object.multDirMatrix(world_axis, direction);
    float facing = 0;
    for (int k = 0; k < 3; ++k) facing += face_area(object.box, k) * std::fabs(direction[k]);
    const double occluding =
        opacity_along(object.opacity, size, direction) * facing * matrix_scale(to_world);
    const double area = face_area(world, axis);
    opacity.axes[axis] = area > 0 ? static_cast<float>(std::min(1.0, occluding / area)) : 0.0f;
  }
  return opacity;
}

/// An instance that can be hit: what the top level stores of it.
struct PlacedInstance {
  Box3f box;
  NodeOpacity opacity;
  InstanceRecord record;
};

PlacedInstance place(const Instance& instance, const ObjectSummary& object, std::uint32_t root,
                     std::size_t source) {
  PlacedInstance placed_instance;
  placed_instance.box = world_box(object.parts, instance.to_world);
  placed_instance.opacity = instance_opacity(object, instance.to_world, placed_instance.box);
  InstanceRecord& record = placed_instance.record;
  store_rows(instance.to_world, record.to_world);
  store_rows(instance.to_world.inverse(), record.to_object);
  record.inverse_det = static_cast<float>(1.0 / matrix_scale(instance.to_world));
  record.root = root;
  record.light = static_cast<std::uint32_t>(instance.light + 1);
  record.source = static_cast<std::uint32_t>(source);
  return placed_instance;
}

/// What a top-level node covers, as its parent needs it.
struct NodeSummary {
  CoverageMap map;
  NormalMoments normals;
};

/// Computes what top-level nodes cover, and stores the opacities of their children. Instances count
/// as uniformly filled boxes, since the coverage maps of an object are not known along the rotated
/// axes.
class TopPrefilter {
 public:
  TopPrefilter(const WideTree& tree, const std::vector<PrimitiveBox>& order,
               const std::vector<PlacedInstance>& placed, LargeVector<BvhNode>& nodes)
      : tree_(tree), order_(order), placed_(placed), nodes_(nodes) {}

  /// The children of the first levels are computed in parallel.
  NodeSummary node(std::uint32_t index, int level = 0) {
    const auto children = tree_.children_of(tree_.nodes[index]);
    std::array<std::optional<NodeSummary>, DAPPLE_BVH_WIDTH> below;  // none of instances
    const auto cover = [&](std::size_t slot) {
      if (!children[slot].count) below[slot].emplace(node(children[slot].first, level + 1));
    };
    if (level < kParallelLevels) {
      tbb::parallel_for(std::size_t{0}, children.size(), cover);
    } else {
      for (std::size_t slot = 0; slot < children.size(); ++slot) cover(slot);
    }
    NodeCoverage coverage(tree_.nodes[index].box);
    NormalMoments normals;
    for (unsigned slot = 0; slot < children.size(); ++slot) {
      const NodeOpacity opacity = add(coverage, children[slot], below[slot]);
      normals.add(opacity.normals);
      set_child_opacity(nodes_[index], slot, opacity, children[slot].box);
    }
    return {coverage.map(), normals};
  }

 private:
  static constexpr int kParallelLevels = 4;

  /// Adds an instance or, if there is one, what is `below`. Returns its opacity.
  NodeOpacity add(NodeCoverage& coverage, const WideChild& child,
                  const std::optional<NodeSummary>& below) const {
    if (below) {
      coverage.add(below->map, child.box);
      return map_opacity(below->map, below->normals, child.box);
    }
    const NodeOpacity& opacity = placed_[order_[child.first].primitive].opacity;
    coverage.add_uniform(opacity.axes, child.box);
    return opacity;
  }

  const WideTree& tree_;
  const std::vector<PrimitiveBox>& order_;
  const std::vector<PlacedInstance>& placed_;
  LargeVector<BvhNode>& nodes_;
};

struct TopLevel {
  LargeVector<BvhNode> nodes;
  LargeVector<InstanceRecord> instances;  ///< in the order of the leaves
  V3f root_opacity{0, 0, 0};
  std::uint32_t stack = 0;  ///< traversal stack entries needed
};

/// Builds the BVH over instances, with one instance per leaf. `first_node`: number of nodes that
/// precede it in the scene.
TopLevel build_top(const std::vector<PlacedInstance>& placed, std::size_t first_node) {
  std::vector<PrimitiveBox> boxes(placed.size());
  tbb::parallel_for(std::size_t{0}, placed.size(), [&](std::size_t i) {
    boxes[i] = primitive_box(placed[i].box, static_cast<std::uint32_t>(i));
  });
  const WideTree wide = build_wide_tree(boxes, 1);
  TopLevel top;
  top.nodes = pack_nodes(wide);
  top.stack = stack_needed(wide);
  const CoverageMap map = TopPrefilter(wide, boxes, placed, top.nodes).node(0).map;
  for (int axis = 0; axis < 3; ++axis) top.root_opacity[axis] = map.mean_opacity(axis);
  std::vector<std::uint32_t> order;
  for (std::size_t n = 0; n < top.nodes.size(); ++n) {
    top.nodes[n].prim_base = static_cast<std::uint32_t>(order.size());
    top.nodes[n].child_base += static_cast<std::uint32_t>(first_node);
    for (const WideChild& child : wide.children_of(wide.nodes[n])) {
      if (child.count) order.push_back(boxes[child.first].primitive);
    }
  }
  top.instances.resize(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(),
                    [&](std::size_t i) { top.instances[i] = placed[order[i]].record; });
  return top;
}

/// The instances whose object is not empty, by index into Scene::instances. Counts what they place.
/// Throws Error if there are none, or too many.
std::vector<std::size_t> filled_instances(const Scene& scene,
                                          const std::vector<ObjectSummary>& objects,
                                          BvhStatistics& statistics) {
  statistics.instanced_triangles = statistics.instanced_segments = 0;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectSummary& object = objects[scene.instances[i].mesh];
    if (object.box.isEmpty()) continue;
    indices.push_back(i);
    (object.has_strands ? statistics.instanced_segments : statistics.instanced_triangles) +=
        object.primitive_count;
  }
  if (indices.empty()) {
    throw Error(ErrorKind::input,
                fmt::format("{}: nothing to hit: every triangle and segment is fully transparent",
                            source_name(scene)));
  }
  if (indices.size() >= DAPPLE_MAX_BLOCKS) {  // higher bits of prim_base are not theirs
    throw Error(ErrorKind::failed,
                fmt::format("{}: {} instances, fewer than {} are possible; merge some",
                            source_name(scene), indices.size(), DAPPLE_MAX_BLOCKS));
  }
  statistics.instances = indices.size();
  return indices;
}

void check_stack(std::uint32_t needed, const std::string& source) {
  if (needed <= DAPPLE_STACK_SIZE) return;
  throw Error(ErrorKind::failed,
              fmt::format("{}: the BVH needs {} traversal stack entries, the kernels have {}; the "
                          "geometry spans too many scales",
                          source, needed, DAPPLE_STACK_SIZE));
}

}  // namespace

LargeVector<BvhNode> place_instances(SceneBvh& bvh, const Scene& scene,
                                     const std::vector<ObjectSummary>& objects,
                                     const std::vector<ObjectOffsets>& offsets) {
  const auto start = std::chrono::steady_clock::now();
  BvhStatistics& statistics = bvh.statistics;
  const std::vector<std::size_t> indices = filled_instances(scene, objects, statistics);
  std::vector<PlacedInstance> placed(indices.size());
  tbb::parallel_for(std::size_t{0}, indices.size(), [&](std::size_t i) {
    const Instance& instance = scene.instances[indices[i]];
    placed[i] = place(instance, objects[instance.mesh], offsets[instance.mesh].node, indices[i]);
  });
  bvh.bounds.makeEmpty();
  std::uint32_t object_stack = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Box3f& box = placed[i].box;
    if (!is_finite(box.min) || !is_finite(box.max))
      throw Error(ErrorKind::input, fmt::format("{}: instance {} has a place that is not finite",
                                                source_name(scene), indices[i]));
    bvh.bounds.extendBy(box);
    object_stack = std::max(object_stack, objects[scene.instances[indices[i]].mesh].stack);
  }
  const Instance& first = scene.instances.front();
  bvh.has_top = scene.instances.size() > 1 || first.to_world != M44f() || first.light >= 0;
  TopLevel top;
  if (bvh.has_top) {
    top = build_top(placed, offsets.back().node);
    bvh.root = offsets.back().node;
  } else {
    top.root_opacity = objects[first.mesh].opacity.axes;
    top.instances.push_back(placed[0].record);
    bvh.root = offsets[first.mesh].node;
  }
  for (int axis = 0; axis < 3; ++axis) statistics.root_opacity[axis] = top.root_opacity[axis];
  check_stack(top.stack + object_stack, source_name(scene));
  bvh.instances = std::move(top.instances);
  statistics.instance_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return std::move(top.nodes);
}

double lane_use(const SceneBvh& bvh) {
  return static_cast<double>(bvh.statistics.triangles + bvh.statistics.segments) /
         (8.0 * static_cast<double>(bvh.blocks.size() + bvh.segments.size()));
}

void describe_objects(BvhStatistics& s, const std::vector<ObjectSummary>& objects) {
  s.triangles = s.segments = s.opaque = s.cut_out = s.translucent = 0;
  std::size_t largest = 0;
  for (const ObjectSummary& object : objects) {
    if (object.has_strands) {
      s.segments += object.primitive_count;
    } else {
      s.triangles += object.primitive_count;
      s.opaque += object.opaque;
      s.cut_out += object.cut_out;
      s.translucent += object.translucent;
    }
    if (object.primitive_count > largest) {
      largest = object.primitive_count;
      s.sah_cost = object.sah_cost;
    }
  }
}

}  // namespace dapple
