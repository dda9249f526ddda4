#include "bvh/object_bvh.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "bvh/quantize.hpp"

namespace dapple {
namespace {

/// Primitives a leaf may hold.
constexpr std::uint32_t kLeafSize = 4;
static_assert(kLeafSize * DAPPLE_BVH_WIDTH <= DAPPLE_MOST_PRIMITIVES);

/// Opacity of each triangle: [0,1], or -(1 + index) of a textured one.
std::vector<float> triangle_opacities(const Scene& scene, const Mesh& mesh, ObjectBvh& object) {
  std::vector<float> opacities(mesh.triangle_count());
  for (std::uint32_t t = 0; t < opacities.size(); ++t) {
    const bool mask = scene.materials[mesh.materials[t]].alpha_mode == AlphaMode::mask;
    if (const auto uniform = uniform_opacity(scene, mesh, t)) {
      opacities[t] = *uniform;
      if (*uniform <= 0.0f) continue;
      ++(mask ? object.cut_out : *uniform >= 1.0f ? object.opaque : object.translucent);
      continue;
    }
    opacities[t] = -1.0f - static_cast<float>(object.textured.size());
    object.textured.push_back(textured_triangle(scene, mesh, t));
    ++(mask ? object.cut_out : object.translucent);
  }
  object.triangles = object.opaque + object.cut_out + object.translucent;
  return opacities;
}

std::vector<PrimitiveBox> primitive_boxes(const Mesh& mesh, const std::vector<float>& opacities) {
  std::vector<PrimitiveBox> boxes;
  boxes.reserve(opacities.size());
  for (std::uint32_t t = 0; t < opacities.size(); ++t) {
    if (opacities[t] == 0.0f) continue;
    Box3f box;
    for (int corner = 0; corner < 3; ++corner) {
      box.extendBy(mesh.positions[mesh.indices[3 * std::size_t{t} + corner]]);
    }
    boxes.push_back({box.min, t, box.max, 0});
  }
  return boxes;
}

void set_lane(TriangleBlock& block, unsigned lane, const Mesh& mesh, std::uint32_t triangle,
              float opacity) {
  const std::uint32_t* index = &mesh.indices[3 * std::size_t{triangle}];
  const V3f vertex = mesh.positions[index[0]];
  const V3f edge1 = mesh.positions[index[1]] - vertex, edge2 = mesh.positions[index[2]] - vertex;
  for (int axis = 0; axis < 3; ++axis) {
    block.vertex[axis][lane] = vertex[axis];
    block.edge1[axis][lane] = edge1[axis];
    block.edge2[axis][lane] = edge2[axis];
  }
  block.opacity[lane] = opacity;
}

/// Triangles of each node's leaves, in slot order, padded to whole blocks a node.
void pack_triangles(BuiltObject& built, const BinaryTree& binary, const Mesh& mesh,
                    const std::vector<float>& opacities) {
  ObjectBvh& object = built.object;
  const WideTree& wide = built.tree;
  const std::vector<bool> closed = closed_triangles(mesh, opacities);
  std::uint32_t blocks = 0;
  for (BvhNode& node : object.nodes) {
    node.prim_base = blocks;
    blocks += (bvh_leaf_end(node.leaf_end, DAPPLE_BVH_WIDTH - 1) + 7u) / 8u;
  }
  object.blocks.assign(blocks, TriangleBlock{});
  if (!closed.empty()) built.closed.assign(blocks, 0);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, wide.nodes.size(), 1024), [&](const auto& range) {
        for (std::size_t n = range.begin(); n < range.end(); ++n) {
          std::uint32_t next = 0;
          for (const WideChild& child : wide.children_of(wide.nodes[n])) {
            for (std::uint32_t i = 0; i < child.count; ++i, ++next) {
              const std::uint32_t triangle = binary.order[child.first + i].primitive;
              const std::uint32_t block = object.nodes[n].prim_base + next / 8;
              set_lane(object.blocks[block], next % 8, mesh, triangle, opacities[triangle]);
              if (!closed.empty() && closed[triangle]) {
                built.closed[block] |= static_cast<std::uint8_t>(1u << next % 8);
              }
            }
          }
        }
      });
}

/// Expected node visits of a random ray through the root's box, by surface areas.
double expected_visits(const WideTree& tree) {
  const double root = half_area(tree.nodes[0].box);
  if (root <= 0) return 1;
  double sum = 0;
  for (const WideNode& node : tree.nodes) sum += half_area(node.box);
  return sum / root;
}

}  // namespace

std::vector<BvhNode> pack_nodes(const WideTree& tree) {
  std::vector<BvhNode> nodes(tree.nodes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), 1024), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const WideNode& wide = tree.nodes[n];
      BvhNode& node = nodes[n];
      set_grid(node, wide.box);
      std::uint32_t primitives = 0;
      for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
        if (slot < wide.child_count) {
          const WideChild& child = tree.children_of(wide)[slot];
          set_child_box(node, slot, child.box);
          primitives += child.count;
          if (child.count == 0) {
            if (node.inner_mask == 0) node.child_base = child.first;
            node.inner_mask = static_cast<uchar>(node.inner_mask | 1u << slot);
          }
        }
        node.leaf_end[slot] = static_cast<uchar>(primitives);
      }
    }
  });
  return nodes;
}

BuiltObject build_object(const Scene& scene, const Mesh& mesh) {
  BuiltObject built;
  ObjectBvh& object = built.object;
  const std::vector<float> opacities = triangle_opacities(scene, mesh, object);
  std::vector<PrimitiveBox> boxes = primitive_boxes(mesh, opacities);
  if (boxes.empty()) return built;
  const BinaryTree binary = build_binary_tree(std::move(boxes), kLeafSize);
  built.tree = collapse(binary);
  const WideNode& root = built.tree.nodes[0];
  object.box = root.box;
  for (const WideChild& child : built.tree.children_of(root)) object.parts.push_back(child.box);
  object.stack = stack_needed(built.tree);
  object.sah_cost = expected_visits(built.tree);
  object.nodes = pack_nodes(built.tree);
  pack_triangles(built, binary, mesh, opacities);
  return built;
}

}  // namespace dapple
