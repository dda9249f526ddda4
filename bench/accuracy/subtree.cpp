// Walks finished BVHs from their roots; rebuilds scenes from triangle blocks, so that what
// is judged is what was packed.
#include "accuracy/subtree.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

namespace dapple::bench {
namespace {

std::size_t add_subtrees(const SceneBvh& bvh, std::uint32_t index, std::vector<Subtree>& out) {
  const BvhNode& node = bvh.nodes[index];
  std::size_t total = 0;
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    const std::size_t below = is_inner(node, slot) ? add_subtrees(bvh, child_node(node, slot), out)
                                                   : bvh_leaf_end(node.leaf_end, slot) -
                                                         bvh_leaf_begin(node.leaf_end, slot);
    if (below > 0) out.push_back({index, slot, below});
    total += below;
  }
  return total;
}

void append_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot,
                  std::vector<LeafTriangle>& out) {
  if (!is_inner(node, slot)) {
    const auto leaf = leaf_triangles(bvh, node, slot);
    out.insert(out.end(), leaf.begin(), leaf.end());
    return;
  }
  const BvhNode& child = bvh.nodes[child_node(node, slot)];
  for (unsigned s = 0; s < DAPPLE_BVH_WIDTH; ++s) append_below(bvh, child, s, out);
}

/// Materials of a rebuilt scene: uniform triangles carry their opacity as vertex alpha,
/// varying ones are told apart by texture and cutoff.
class Materials {
 public:
  explicit Materials(Scene& scene) : scene_(scene) {}

  std::uint32_t find(int texture, float cutoff) {
    const auto [at, added] = index_.try_emplace(
        std::pair(texture, cutoff), static_cast<std::uint32_t>(scene_.materials.size()));
    if (added) {
      Material material;
      material.alpha_mode = cutoff < 0.0f ? AlphaMode::blend : AlphaMode::mask;
      material.alpha_cutoff = cutoff;
      material.alpha_texture = texture;
      scene_.materials.push_back(material);
    }
    return at->second;
  }

 private:
  Scene& scene_;
  std::map<std::pair<int, float>, std::uint32_t> index_;
};

void append_triangle(Mesh& mesh, const LeafTriangle& triangle, const TexturedTriangle* textured) {
  for (const V3f& corner :
       {triangle.vertex, triangle.vertex + triangle.edge1, triangle.vertex + triangle.edge2}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(corner);
  }
  for (int corner = 0; corner < 3; ++corner) {
    mesh.uvs.push_back(textured ? V2f(textured->uv[corner][0], textured->uv[corner][1])
                                : V2f(0.0f));
    mesh.vertex_alpha.push_back(textured ? textured->alpha[corner] : triangle.opacity);
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
  for (std::uint32_t i = bvh_leaf_begin(node.leaf_end, slot); i < bvh_leaf_end(node.leaf_end, slot);
       ++i) {
    const TriangleBlock& block = bvh.blocks[node.prim_base + i / 8];
    const auto at = [lane = i % 8](const float(&v)[3][8]) {
      return V3f(v[0][lane], v[1][lane], v[2][lane]);
    };
    triangles.push_back({at(block.vertex), at(block.edge1), at(block.edge2), block.opacity[i % 8]});
  }
  return triangles;
}

std::vector<LeafTriangle> triangles_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot) {
  std::vector<LeafTriangle> triangles;
  append_below(bvh, node, slot, triangles);
  return triangles;
}

Scene scene_of(const std::vector<LeafTriangle>& triangles, const SceneBvh& bvh,
               const Scene& scene) {
  Scene part;
  part.textures = scene.textures;
  part.meshes.emplace_back();
  part.instances.push_back({0, M44f(), -1});
  Materials materials(part);
  Mesh& mesh = part.meshes[0];
  for (const LeafTriangle& triangle : triangles) {
    const TexturedTriangle* textured =
        triangle.opacity < 0.0f ? &bvh.textured[static_cast<std::size_t>(-triangle.opacity - 1.0f)]
                                : nullptr;
    append_triangle(mesh, triangle, textured);
    const bool has_texture = textured && textured->texture != DAPPLE_NO_TEXTURE;
    mesh.materials.push_back(
        materials.find(has_texture ? static_cast<int>(textured->texture) : -1,
                       textured && textured->cutoff >= 0.0f ? textured->cutoff : -1.0f));
  }
  return part;
}

}  // namespace dapple::bench
