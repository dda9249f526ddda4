// Visits finished BVHs from their roots. Scenes are rebuilt from triangle blocks, so that the
// reference has the same triangles as the BVH.
#include "accuracy/subtree.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include "bvh/build/object_bvh.hpp"
#include "bvh/storage/segment_block.hpp"
#include "bvh/storage/textured_triangle.hpp"

namespace dapple::bench {
namespace {

std::size_t add_subtrees(const SceneBvh& bvh, std::uint32_t index, std::vector<Subtree>& out) {
  const BvhNode& node = bvh.nodes[index];
  std::size_t total = 0;
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    const std::size_t below = is_inner(node, slot)
                                  ? add_subtrees(bvh, child_node(node, slot), out)
                                  : bvh_leaf_end(node.leaf_end, slot) - bvh_leaf_begin(&node, slot);
    if (below > 0) out.push_back({index, slot, below});
    total += below;
  }
  return total;
}

template <class Primitive, class OfLeaf>
void append_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot, const OfLeaf& of_leaf,
                  std::vector<Primitive>& out) {
  if (!is_inner(node, slot)) {
    const auto leaf = of_leaf(bvh, node, slot);
    out.insert(out.end(), leaf.begin(), leaf.end());
    return;
  }
  const BvhNode& child = bvh.nodes[child_node(node, slot)];
  for (unsigned s = 0; s < DAPPLE_BVH_WIDTH; ++s) append_below(bvh, child, s, of_leaf, out);
}

/// Materials of a rebuilt scene. Constant-opacity triangles have their opacity as vertex alpha.
/// Others keep their material, but without its texture if that was not used.
class Materials {
 public:
  Materials(Scene& scene, const Scene& original) : scene_(scene), original_(original) {}

  std::uint32_t uniform() {
    Material material;
    material.alpha_mode = AlphaMode::blend;
    return find({-1, false}, material);
  }

  std::uint32_t of(const TexturedCorners& corners) {
    Material material = original_.materials[corners.material];
    material.uses_vertex_alpha = true;  // unused alphas are 1
    if (!corners.has_texture) material.alpha_texture = -1;
    return find({corners.material, corners.has_texture}, material);
  }

 private:
  using Key = std::pair<std::int64_t, bool>;  ///< index of the original, has a texture

  std::uint32_t find(const Key& key, const Material& material) {
    const auto [at, added] =
        index_.try_emplace(key, static_cast<std::uint32_t>(scene_.materials.size()));
    if (added) scene_.materials.push_back(material);
    return at->second;
  }

  Scene& scene_;
  const Scene& original_;
  std::map<Key, std::uint32_t> index_;
};

void append_triangle(Mesh& mesh, const LeafTriangle& triangle, const TexturedCorners& corners) {
  for (const V3f& corner :
       {triangle.vertex, triangle.vertex + triangle.edge1, triangle.vertex + triangle.edge2}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(corner);
  }
  for (int corner = 0; corner < 3; ++corner) {
    mesh.uvs.push_back(corners.uv[corner]);
    mesh.vertex_alpha.push_back(corners.alpha[corner]);
  }
}

}  // namespace

std::uint32_t child_node(const BvhNode& node, unsigned slot) {
  const unsigned before = node.inner_mask & ((1u << slot) - 1u);
  return node.child_base + static_cast<std::uint32_t>(std::popcount(before));
}

std::vector<std::uint32_t> object_roots(const SceneBvh& bvh) {
  std::vector<std::uint32_t> roots;
  for (const InstanceRecord& instance : bvh.instances) roots.push_back(instance.root);
  std::sort(roots.begin(), roots.end());
  roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
  return roots;
}

std::vector<Subtree> list_subtrees(const SceneBvh& bvh) {
  std::vector<Subtree> subtrees;
  for (const std::uint32_t root : object_roots(bvh)) add_subtrees(bvh, root, subtrees);
  return subtrees;
}

std::vector<LeafTriangle> leaf_triangles(const SceneBvh& bvh, const BvhNode& node, unsigned slot) {
  std::vector<LeafTriangle> triangles;
  for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot); ++i) {
    const TriangleBlock& block = bvh.blocks[bvh_block(node.prim_base, i)];
    triangles.push_back({corner_of(block, 0, i % 8), edge_of(block, 1, i % 8),
                         edge_of(block, 2, i % 8), block.opacity[i % 8]});
  }
  return triangles;
}

std::vector<LeafTriangle> triangles_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot) {
  std::vector<LeafTriangle> triangles;
  append_below(bvh, node, slot, leaf_triangles, triangles);
  return triangles;
}

std::vector<StrandSegment> leaf_segments(const SceneBvh& bvh, const BvhNode& node, unsigned slot) {
  std::vector<StrandSegment> segments;
  for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot); ++i) {
    const SegmentBlock& block = bvh.segments[bvh_block_index(bvh_block(node.prim_base, i))];
    segments.push_back(unpack_segment(block, i % 8));
  }
  return segments;
}

std::vector<StrandSegment> segments_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot) {
  std::vector<StrandSegment> segments;
  append_below(bvh, node, slot, leaf_segments, segments);
  return segments;
}

Scene scene_of(const std::vector<LeafTriangle>& triangles, const SceneBvh& bvh,
               const Scene& scene) {
  Scene part;
  part.textures = scene.textures;
  part.meshes.emplace_back();
  part.instances.push_back({0, M44f(), -1});
  Materials materials(part, scene);
  Mesh& mesh = part.meshes[0];
  for (const LeafTriangle& triangle : triangles) {
    if (triangle.opacity < 0.0f) {
      const auto index = static_cast<std::size_t>(-triangle.opacity - 1.0f);
      const TexturedCorners corners = unpack_textured(bvh.textured[index]);
      append_triangle(mesh, triangle, corners);
      mesh.materials.push_back(materials.of(corners));
    } else {
      TexturedCorners corners;
      corners.alpha.fill(triangle.opacity);
      append_triangle(mesh, triangle, corners);
      mesh.materials.push_back(materials.uniform());
    }
  }
  return part;
}

}  // namespace dapple::bench
