#include "scene/procedural/tree_wood.hpp"

#include "scene/procedural/mesh_shapes.hpp"

namespace dapple {
namespace {

// Finds for each node the child that continues its branch, the thickest one; 0 for none.
std::vector<std::uint32_t> find_leaders(const TreeSkeleton& tree) {
  std::vector<std::uint32_t> leaders(tree.size(), 0);
  for (std::uint32_t node = 1; node < tree.size(); ++node) {
    std::uint32_t& leader = leaders[tree.parents[node]];
    if (leader == 0 || tree.radii[node] > tree.radii[leader]) leader = node;
  }
  return leaders;
}

int sides_of(float radius, float trunk_radius) {
  const float share = radius / trunk_radius;
  return share > 0.5f ? 12 : share > 0.25f ? 7 : share > 0.12f ? 5 : 3;
}

/// Moves the vertices of a tube from their rest positions, and turns their normals. The tube begins
/// at vertex `first`, and its rings are around `nodes`.
void sway_tube(Mesh& mesh, std::size_t first, const std::vector<std::uint32_t>& nodes, int sides,
               const SwayingSkeleton& swaying) {
  for (std::size_t v = first; v < mesh.positions.size(); ++v) {
    const std::uint32_t node = nodes[(v - first) / static_cast<std::size_t>(sides)];
    mesh.positions[v] = swaying.moved(node, mesh.positions[v]);
    if (sides >= kSmoothSides) mesh.normals[v] = swaying.turned(node, mesh.normals[v]);
  }
}

}  // namespace

void append_wood(Mesh& mesh, const TreeSkeleton& tree, const SwayingSkeleton* swaying,
                 std::uint32_t material) {
  const std::vector<std::uint32_t> leaders = find_leaders(tree);
  std::vector<std::uint32_t> nodes;
  std::vector<V3f> points;
  std::vector<float> radii;
  for (std::uint32_t first = 1; first < tree.size(); ++first) {
    const std::uint32_t parent = tree.parents[first];
    const bool is_trunk = parent == 0 && leaders[0] == first;
    if (!is_trunk && leaders[parent] == first) continue;
    nodes = {parent};
    points = {tree.positions[parent]};
    radii = {tree.radii[is_trunk ? parent : first]};
    for (std::uint32_t node = first; node != 0; node = leaders[node]) {
      nodes.push_back(node);
      points.push_back(tree.positions[node]);
      radii.push_back(tree.radii[node]);
    }
    const std::size_t first_vertex = mesh.positions.size();
    const int sides = sides_of(radii[0], tree.radii[0]);
    append_tube(mesh, points, radii, sides, material);
    if (swaying != nullptr) sway_tube(mesh, first_vertex, nodes, sides, *swaying);
  }
}

}  // namespace dapple
