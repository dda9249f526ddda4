#include "bvh/build/top_level.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

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

/// Returns the world box around the boxes of the root's children. It is tighter than the world box
/// around the root's box.
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
  record.inverse_area_scale = static_cast<float>(1.0 / matrix_scale(instance.to_world));
  record.root = root;
  record.light = static_cast<std::uint32_t>(instance.light + 1);
  record.source = static_cast<std::uint32_t>(source);
  return placed_instance;
}

/// Returns the coverage and the normals of a top-level node, and sets the opacities below it.
/// Instances count as uniformly filled boxes, since the coverage maps of an object are not known
/// along the rotated axes.
std::pair<CoverageMap, NormalMoments> prefilter_top(const WideTree& tree,
                                                    const std::vector<PrimitiveBox>& order,
                                                    const std::vector<PlacedInstance>& placed,
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
  std::vector<InstanceRecord> instances;  ///< in the order of the leaves
  V3f root_opacity{0, 0, 0};
  std::uint32_t stack = 0;  ///< traversal stack entries needed
};

/// Builds the BVH over instances, with one instance per leaf. `first_node`: number of nodes that
/// precede it in the scene.
TopLevel build_top(const std::vector<PlacedInstance>& placed, std::size_t first_node) {
  std::vector<PrimitiveBox> boxes;
  for (std::uint32_t i = 0; i < placed.size(); ++i)
    boxes.push_back(primitive_box(placed[i].box, i));
  const WideTree wide = build_wide_tree(boxes, 1);
  TopLevel top;
  top.nodes = pack_nodes(wide);
  top.stack = stack_needed(wide);
  const CoverageMap map = prefilter_top(wide, boxes, placed, top.nodes, 0).first;
  for (int axis = 0; axis < 3; ++axis) top.root_opacity[axis] = map.mean_opacity(axis);
  for (std::size_t n = 0; n < top.nodes.size(); ++n) {
    top.nodes[n].prim_base = static_cast<std::uint32_t>(top.instances.size());
    top.nodes[n].child_base += static_cast<std::uint32_t>(first_node);
    for (const WideChild& child : wide.children_of(wide.nodes[n])) {
      if (child.count) top.instances.push_back(placed[boxes[child.first].primitive].record);
    }
  }
  return top;
}

void check_stack(std::uint32_t needed, const std::string& source) {
  if (needed <= DAPPLE_STACK_SIZE) return;
  throw Error(ErrorKind::failed,
              fmt::format("{}: the BVH needs {} traversal stack entries, the kernels have {}; the "
                          "geometry spans too many scales",
                          source, needed, DAPPLE_STACK_SIZE));
}

}  // namespace

std::vector<BvhNode> place_instances(SceneBvh& bvh, const Scene& scene,
                                     const std::vector<ObjectSummary>& objects,
                                     const std::vector<ObjectOffsets>& offsets) {
  BvhStatistics& statistics = bvh.statistics;
  bvh.bounds.makeEmpty();
  statistics.instanced_triangles = statistics.instanced_segments = 0;
  std::vector<PlacedInstance> placed;
  std::uint32_t object_stack = 0;
  for (const Instance& instance : scene.instances) {
    const ObjectSummary& object = objects[instance.mesh];
    if (object.box.isEmpty()) continue;
    const auto source = static_cast<std::size_t>(&instance - scene.instances.data());
    placed.push_back(place(instance, object, offsets[instance.mesh].node, source));
    bvh.bounds.extendBy(placed.back().box);
    (object.has_strands ? statistics.instanced_segments : statistics.instanced_triangles) +=
        object.triangles;
    object_stack = std::max(object_stack, object.stack);
  }
  if (placed.empty()) {
    throw Error(ErrorKind::input,
                fmt::format("{}: nothing to hit: every triangle and segment is fully transparent",
                            scene.source));
  }
  statistics.instances = placed.size();
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
  check_stack(top.stack + object_stack, scene.source);
  bvh.instances = std::move(top.instances);
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
      s.segments += object.triangles;
    } else {
      s.triangles += object.triangles;
      s.opaque += object.opaque;
      s.cut_out += object.cut_out;
      s.translucent += object.translucent;
    }
    if (object.triangles > largest) {
      largest = object.triangles;
      s.sah_cost = object.sah_cost;
    }
  }
}

}  // namespace dapple
