// All objects' BVHs put together, and the top-level BVH over their instances.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "bvh/joined_objects.hpp"
#include "bvh/scene_objects.hpp"
#include "dapple/bvh.hpp"
#include "dapple/error.hpp"

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

/// World box around the boxes of the root's children: tighter than around the root's own.
Box3f world_box(const std::vector<Box3f>& parts, const M44f& to_world) {
  Box3f world;
  for (const Box3f& box : parts) {
    for (int corner = 0; corner < 8; ++corner) {
      const V3f p(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                  corner & 4 ? box.max.z : box.min.z);
      world.extendBy(p * to_world);
    }
  }
  return world;
}

/// The object's root opacity as that of its world box: along a world axis e the object is
/// crossed in direction M^-1 e, and areas grow by |det M| |M^-1 e|.
NodeOpacity instance_opacity(const ObjectSummary& object, const M44f& to_world,
                             const Box3f& world) {
  const M44f to_object = to_world.inverse();
  const V3f size = object.box.max - object.box.min;
  NodeOpacity opacity;
  opacity.normals = object.opacity.normals.placed(to_world);
  opacity.clumping = object.opacity.clumping;
  opacity.concentration = object.opacity.concentration;
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

void add_statistics(BvhStatistics& s, const std::vector<FinishedObject>& objects) {
  std::size_t largest = 0;
  for (const FinishedObject& object : objects) {
    if (object.segments.empty()) {
      s.triangles += object.triangles;
      s.opaque += object.opaque;
      s.cut_out += object.cut_out;
      s.translucent += object.translucent;
    } else {
      s.segments += object.triangles;
    }
    if (object.triangles > largest) {
      largest = object.triangles;
      s.sah_cost = object.sah_cost;
    }
  }
}

/// An instance that can be hit, as the top level sees it.
struct Placement {
  Box3f box;
  NodeOpacity opacity;
  InstanceRecord record;
};

Placement place(const Instance& instance, const ObjectSummary& object, std::uint32_t root) {
  Placement placement;
  placement.box = world_box(object.parts, instance.to_world);
  placement.opacity = instance_opacity(object, instance.to_world, placement.box);
  InstanceRecord& record = placement.record;
  store_rows(instance.to_world, record.to_world);
  store_rows(instance.to_world.inverse(), record.to_object);
  record.inverse_area_scale = static_cast<float>(1.0 / matrix_scale(instance.to_world));
  record.root = root;
  record.light = static_cast<std::uint32_t>(instance.light + 1);
  record.spare = 0;
  return placement;
}

/// Coverage and normals of a top-level node; sets the opacities below it. Instances count
/// as evenly filled boxes: how an object clumps is not known along turned axes.
std::pair<CoverageMap, NormalMoments> prefilter_top(const WideTree& tree,
                                                    const std::vector<PrimitiveBox>& order,
                                                    const std::vector<Placement>& placed,
                                                    std::vector<BvhNode>& nodes,
                                                    std::uint32_t index) {
  const WideNode& wide = tree.nodes[index];
  NodeCoverage coverage(wide.box);
  NormalMoments normals;
  for (unsigned slot = 0; slot < wide.child_count; ++slot) {
    const WideChild& child = tree.children_of(wide)[slot];
    CoverageMap map;
    NodeOpacity opacity;
    if (child.count) {
      opacity = placed[order[child.first].primitive].opacity;
      map = uniform_map(opacity.axes);
    } else {
      NormalMoments below;
      std::tie(map, below) = prefilter_top(tree, order, placed, nodes, child.first);
      opacity = map_opacity(map, below, child.box);
    }
    coverage.add(map, child.box);
    normals.add(opacity.normals);
    set_child_opacity(nodes[index], slot, opacity, child.box);
  }
  return {coverage.map(), normals};
}

struct TopLevel {
  std::vector<BvhNode> nodes;
  std::uint32_t stack = 0;  ///< traversal stack entries needed
};

/// The BVH over instances, one a leaf; its nodes will follow `first_node` others.
TopLevel build_top(SceneBvh& bvh, const std::vector<Placement>& placed, std::size_t first_node) {
  std::vector<PrimitiveBox> boxes;
  for (std::uint32_t i = 0; i < placed.size(); ++i)
    boxes.push_back(primitive_box(placed[i].box, i));
  const WideTree wide = build_wide_tree(boxes, 1);
  std::vector<BvhNode> nodes = pack_nodes(wide);
  const CoverageMap map = prefilter_top(wide, boxes, placed, nodes, 0).first;
  for (int axis = 0; axis < 3; ++axis) bvh.statistics.root_opacity[axis] = map.mean_opacity(axis);
  bvh.root = static_cast<std::uint32_t>(first_node);
  bvh.has_top = true;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    nodes[n].prim_base = static_cast<std::uint32_t>(bvh.instances.size());
    nodes[n].child_base += bvh.root;
    for (const WideChild& child : wide.children_of(wide.nodes[n])) {
      if (child.count) bvh.instances.push_back(placed[boxes[child.first].primitive].record);
    }
  }
  return {std::move(nodes), stack_needed(wide)};
}

void check_stack(std::uint32_t needed, const std::string& source) {
  if (needed <= DAPPLE_STACK_SIZE) return;
  throw Error(ErrorKind::failed,
              fmt::format("{}: the BVH needs {} traversal stack entries, the kernels have {}; the "
                          "geometry spans too many scales",
                          source, needed, DAPPLE_STACK_SIZE));
}

}  // namespace

SceneBvh build_bvh(const Scene& scene, const std::string& cache_folder) {
  if (!cache_folder.empty()) prepare_bvh_cache(cache_folder);
  SceneBvh bvh;
  std::vector<FinishedObject> objects = finish_objects(scene, cache_folder, bvh.statistics);
  add_statistics(bvh.statistics, objects);
  const std::vector<ObjectOffsets> offsets = lay_out(objects, scene.source);
  std::vector<Placement> placed;
  std::uint32_t object_stack = 0;
  for (const Instance& instance : scene.instances) {
    const FinishedObject& object = objects[instance.mesh];
    if (object.box.isEmpty()) continue;
    placed.push_back(place(instance, object, offsets[instance.mesh].node));
    bvh.bounds.extendBy(placed.back().box);
    BvhStatistics& s = bvh.statistics;
    (object.segments.empty() ? s.instanced_triangles : s.instanced_segments) += object.triangles;
    object_stack = std::max(object_stack, object.stack);
  }
  if (placed.empty()) {
    throw Error(ErrorKind::input,
                fmt::format("{}: nothing to hit: every triangle and segment is fully transparent",
                            scene.source));
  }
  bvh.statistics.instances = placed.size();
  const Instance& first = scene.instances.front();
  TopLevel top;
  if (scene.instances.size() == 1 && first.to_world == M44f() && first.light < 0) {
    bvh.root = offsets[first.mesh].node;
    bvh.instances.push_back(placed[0].record);
    for (int axis = 0; axis < 3; ++axis)
      bvh.statistics.root_opacity[axis] = objects[first.mesh].opacity.axes[axis];
  } else {
    top = build_top(bvh, placed, offsets.back().node);
  }
  check_stack(top.stack + object_stack, scene.source);
  join(bvh, objects, offsets, std::move(top.nodes));
  bvh.statistics.lane_use =
      static_cast<double>(bvh.statistics.triangles + bvh.statistics.segments) /
      (8.0 * static_cast<double>(bvh.blocks.size() + bvh.segments.size()));
  return bvh;
}

}  // namespace dapple
