#include "bvh/build/object_bvh.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <span>

#include "bvh/build/block_layout.hpp"
#include "bvh/build/coincident_triangles.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/triangle_opacity.hpp"
#include "bvh/opacity/wall.hpp"
#include "bvh/opacity/welded_vertices.hpp"
#include "bvh/storage/packed_strands.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Maximum number of primitives of a leaf.
constexpr std::uint32_t kLeafSize = 4;
static_assert(kLeafSize * DAPPLE_BVH_WIDTH <= DAPPLE_MAX_PRIMITIVES);

/// Triangles of one task of a parallel loop.
constexpr std::uint32_t kGrain = 1u << 14;

template <class Body>
void for_each_block(std::size_t count, const Body& body) {
  tbb::parallel_for(std::size_t{0}, (count + kGrain - 1) / kGrain, [&](std::size_t block) {
    body(block, block * kGrain, std::min(count, (block + 1) * kGrain));
  });
}

/// Marks a textured triangle until its index is known.
constexpr float kTextured = -1.0f;

/// Returns the opacity of each primitive, [0,1], or kTextured. Counts the primitives of each kind
/// in `object`.
std::vector<float> uniform_opacities(const Scene& scene, const OpaqueTexels& texels,
                                     const Mesh& mesh, ObjectBvh& object) {
  std::vector<float> opacities(mesh.primitive_count());
  std::atomic<std::size_t> opaque = 0, cut_out = 0, translucent = 0;
  for_each_block(opacities.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    std::size_t here[3] = {0, 0, 0};
    for (std::size_t t = begin; t < end; ++t) {
      const bool mask = scene.materials[mesh.materials[t]].alpha_mode == AlphaMode::mask;
      const auto index = static_cast<std::uint32_t>(t);
      opacities[t] = mesh.has_strands()
                         ? segment_opacity(scene, mesh, index)
                         : uniform_opacity(scene, texels, mesh, index).value_or(kTextured);
      if (opacities[t] != 0.0f) ++here[mask ? 1 : opacities[t] >= 1.0f ? 0 : 2];
    }
    opaque += here[0];
    cut_out += here[1];
    translucent += here[2];
  });
  object.opaque = opaque;
  object.cut_out = cut_out;
  object.translucent = translucent;
  object.primitive_count = object.opaque + object.cut_out + object.translucent;
  return opacities;
}

/// Returns the opacity of each triangle, [0,1], or -(1 + index) for a textured triangle.
std::vector<float> triangle_opacities(const Scene& scene, const OpaqueTexels& texels,
                                      const Mesh& mesh, ObjectBvh& object) {
  std::vector<float> opacities = uniform_opacities(scene, texels, mesh, object);
  std::vector<std::uint32_t> textured;
  for (std::uint32_t t = 0; t < opacities.size(); ++t) {
    if (opacities[t] >= 0.0f) continue;
    opacities[t] = -1.0f - static_cast<float>(textured.size());
    textured.push_back(t);
    check_textured_count(scene, textured.size());
  }
  // Coincident triangles are not averaged: both sides of a card have the same transmittance at each
  // point, so the product of their means would be too small.
  const std::vector<std::uint8_t> coincident = find_coincident(mesh, textured);
  for (std::size_t i = 0; i < textured.size(); ++i)
    object.textured.push_back(textured_triangle(scene, mesh, textured[i], coincident[i] == 0));
  return opacities;
}

bool is_infinite(const Box3f& box) {
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::fabs(box.min[axis]), std::fabs(box.max[axis])});
  return largest > std::numeric_limits<float>::max();
}

/// Lists the primitives that are not fully transparent, in order, and sets `boxes`, one for each.
/// Readers and merge_single_instances() drop those whose vertices are not finite; of other callers
/// infinite ones are refused.
template <class BoxOf>
void fill_boxes(const Mesh& mesh, const std::vector<float>& opacities,
                std::span<PrimitiveBox> boxes, const BoxOf& box_of) {
  std::vector<std::size_t> next((opacities.size() + kGrain - 1) / kGrain + 1, 0);
  for_each_block(opacities.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    const auto transparent = std::count(&opacities[begin], opacities.data() + end, 0.0f);
    next[block + 1] = end - begin - static_cast<std::size_t>(transparent);
  });
  std::partial_sum(next.begin(), next.end(), next.begin());
  for_each_block(opacities.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::size_t to = next[block];
    for (std::size_t t = begin; t < end; ++t) {
      if (opacities[t] == 0.0f) continue;
      const auto index = static_cast<std::uint32_t>(t);
      const Box3f box = box_of(index);
      if (is_infinite(box))
        throw Error(ErrorKind::input,
                    fmt::format("mesh \"{:.100}\" has vertices at infinity", mesh.name));
      boxes[to++] = primitive_box(box, index);
    }
  });
}

/// The lanes whose triangles have a flag, a byte for each block.
std::vector<std::uint8_t> lanes_with(const std::vector<bool>& flags,
                                     std::span<const std::uint32_t> primitives) {
  std::vector<std::uint8_t> lanes(flags.empty() ? 0 : primitives.size() / 8);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lanes.size(), 4096), [&](const auto& range) {
    for (std::size_t i = 8 * range.begin(); i < 8 * range.end(); ++i) {
      const bool set = primitives[i] != kNoPrimitive && flags[primitives[i]];
      lanes[i / 8] = static_cast<std::uint8_t>(lanes[i / 8] | unsigned{set} << i % 8);
    }
  });
  return lanes;
}

/// The values of the lanes' triangles; 0 where a lane has none.
std::vector<float> by_lane(const std::vector<float>& values,
                           std::span<const std::uint32_t> primitives) {
  std::vector<float> lanes(values.empty() ? 0 : primitives.size());
  tbb::parallel_for(std::size_t{0}, lanes.size(), [&](std::size_t i) {
    if (primitives[i] != kNoPrimitive) lanes[i] = values[primitives[i]];
  });
  return lanes;
}

/// Sets where the primitives of a node begin. Leaf ends count from lane 0 of the block.
void begin_at(BvhNode& node, std::uint32_t prim_base) {
  node.prim_base = prim_base;
  for (uchar& end : node.leaf_end) end = static_cast<uchar>(end + bvh_first_lane(prim_base));
}

/// Packs the triangles of each node's leaves, in the order of the slots.
void pack_triangles(BuiltObject& built, const BlockLayout& layout,
                    std::span<const PrimitiveBox> boxes, const Mesh& mesh,
                    const std::vector<float>& opacities) {
  ObjectBvh& object = built.object;
  const WideTree& wide = built.tree;
  object.primitives.assign(8 * std::size_t{layout.blocks}, kNoPrimitive);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, wide.nodes.size(), 1024), [&](const auto& range) {
        for (std::size_t n = range.begin(); n < range.end(); ++n) {
          BvhNode& node = object.nodes[n];
          begin_at(node, layout.prim_base[n]);
          std::uint32_t next = bvh_first_lane(node.prim_base);
          for (const WideChild& child : wide.children_of(wide.nodes[n])) {
            for (std::uint32_t i = 0; i < child.count; ++i, ++next) {
              const std::uint32_t triangle = boxes[child.first + i].primitive;
              const std::uint32_t block = bvh_block(node.prim_base, next);
              set_lane(object.blocks[block], next % 8, mesh, triangle, opacities[triangle]);
              object.primitives[8 * std::size_t{block} + next % 8] = triangle;
            }
          }
        }
      });
}

/// Expected node visits of a random ray through the root's box, by surface areas.
double expected_visits(const WideTree& tree) {
  double sum = 0;
  for (const WideNode& node : tree.nodes) sum += half_area(node.box);
  return dapple::expected_visits(sum, tree.nodes[0].box);
}

}  // namespace

// Minima and maxima without branches: the branches of Imath's extendBy() are unpredictable.
Box3f triangle_box(const Mesh& mesh, std::size_t triangle) {
  const std::uint32_t* index = &mesh.indices[3 * triangle];
  const V3f &a = mesh.positions[index[0]], &b = mesh.positions[index[1]],
            &c = mesh.positions[index[2]];
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::min(std::min(a[axis], b[axis]), c[axis]);
    box.max[axis] = std::max(std::max(a[axis], b[axis]), c[axis]);
  }
  return box;
}

void set_lane(TriangleBlock& block, unsigned lane, const Mesh& mesh, std::uint32_t triangle,
              float opacity) {
  const std::uint32_t* index = &mesh.indices[3 * std::size_t{triangle}];
  for (int corner = 0; corner < 3; ++corner) {
    const V3f& position = mesh.positions[index[corner]];
    for (int axis = 0; axis < 3; ++axis) block.vertex[corner][axis][lane] = position[axis];
  }
  block.opacity[lane] = opacity;
}

double expected_visits(double half_areas, const Box3f& root) {
  const double area = half_area(root);
  return area > 0 ? half_areas / area : 1;
}

LargeVector<BvhNode> pack_nodes(const WideTree& tree) {
  LargeVector<BvhNode> nodes(tree.nodes.size());
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

namespace {

/// Fills the summary and the nodes of an object whose tree is built.
void summarize(BuiltObject& built) {
  ObjectBvh& object = built.object;
  const WideTree& tree = built.tree;
  object.box = tree.nodes[0].box;
  for (const WideChild& child : tree.children_of(tree.nodes[0])) object.parts.push_back(child.box);
  tbb::parallel_invoke([&] { object.nodes = pack_nodes(tree); },
                       [&] { object.stack = stack_needed(tree); },
                       [&] { object.sah_cost = expected_visits(tree); });
}

void build_triangles(const Mesh& mesh, const std::vector<float>& opacities,
                     std::span<PrimitiveBox> boxes, BuiltObject& built) {
  fill_boxes(mesh, opacities, boxes, [&](std::uint32_t t) { return triangle_box(mesh, t); });
  std::vector<bool> closed;
  std::vector<float> interior;
  tbb::parallel_invoke([&] { built.tree = build_wide_tree(boxes, kLeafSize); },
                       [&] {
                         const OpaqueTriangles opaque(mesh, opacities);
                         const std::vector<std::uint32_t> welded =
                             welded_vertices(opaque.positions(), opaque.indices());
                         tbb::parallel_invoke(
                             [&] { closed = closed_triangles(opaque, welded); },
                             [&] { interior = interior_triangles(opaque, welded); });
                       });
  BlockLayout layout;
  tbb::parallel_invoke(
      [&] {
        layout = lay_out_blocks(built.tree);
        built.object.blocks.resize(layout.blocks);
      },
      [&] { summarize(built); });
  pack_triangles(built, layout, boxes, mesh, opacities);
  built.closed = lanes_with(closed, built.object.primitives);
  built.interior = by_lane(interior, built.object.primitives);
}

void build_strands(const Mesh& mesh, const std::vector<float>& opacities,
                   std::span<PrimitiveBox> boxes, BuiltObject& built) {
  const StrandJoints joints(mesh);
  fill_boxes(mesh, opacities, boxes,
             [&](std::uint32_t s) { return bounds(joints.segment(mesh, s)); });
  built.tree = build_wide_tree(boxes, kLeafSize);
  PackedStrands packed = pack_strands(built.tree, boxes, mesh, joints, opacities);
  built.object.segments = std::move(packed.blocks);
  built.object.primitives = std::move(packed.primitives);
  summarize(built);
  for (std::size_t n = 0; n < built.object.nodes.size(); ++n) {
    built.object.nodes[n].prim_base = DAPPLE_SEGMENTS | packed.first_block[n];
  }
}

}  // namespace

BuiltObject build_object(const Scene& scene, const OpaqueTexels& texels, const Mesh& mesh) {
  BuiltObject built;
  ObjectBvh& object = built.object;
  object.has_strands = mesh.has_strands();
  const std::vector<float> opacities = triangle_opacities(scene, texels, mesh, object);
  if (object.primitive_count == 0) return built;
  // Not initialized: the page faults then happen in the threads that write the pages.
  const auto storage = std::make_unique_for_overwrite<PrimitiveBox[]>(object.primitive_count);
  const std::span boxes(storage.get(), object.primitive_count);
  if (mesh.has_strands())
    build_strands(mesh, opacities, boxes, built);
  else
    build_triangles(mesh, opacities, boxes, built);
  return built;
}

}  // namespace dapple
