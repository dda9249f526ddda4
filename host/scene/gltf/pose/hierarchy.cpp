// Flattens the node tree and multiplies its matrices: see hierarchy.hpp.
#include "scene/gltf/pose/hierarchy.hpp"

#include <Imath/ImathQuat.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::M44d;
using Imath::V3d;
using Imath::V4d;

/// Deeper trees are of no exporter, and their matrices are the products of as many.
constexpr int kMaxDepth = 65'536;

/// The allowed difference between a matrix's last column and 0, 0, 0, 1: exporters round.
constexpr double kAffineTolerance = 1e-4;

std::string node_label(const Document& document, int node) {
  return element("node", static_cast<std::size_t>(node),
                 document.model.nodes[static_cast<std::size_t>(node)].name);
}

/// Returns each node's parent, -1 for roots.
std::vector<int> find_parents(const Document& document) {
  const auto& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      int& parent = parents[static_cast<std::size_t>(child)];
      if (parent >= 0) {
        fail(document.file, "{} is a child of both node {} and node {}",
             node_label(document, child), parent, i);
      }
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

/// Each node has at most one parent, so a node that no root leads to is on a cycle or below one.
void check_tree(const Document& document, const std::vector<int>& parents) {
  const auto& nodes = document.model.nodes;
  std::vector<int> depth(nodes.size(), 0);
  std::vector<int> open;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (parents[i] >= 0) continue;
    depth[i] = 1;
    open.push_back(static_cast<int>(i));
  }
  while (!open.empty()) {
    const auto at = static_cast<std::size_t>(open.back());
    open.pop_back();
    if (depth[at] > kMaxDepth) {
      fail(document.file, "{} is nested deeper than {} nodes",
           node_label(document, static_cast<int>(at)), grouped(kMaxDepth));
    }
    for (const int child : nodes[at].children) {
      depth[static_cast<std::size_t>(child)] = depth[at] + 1;
      open.push_back(child);
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (depth[i] == 0) {
      fail(document.file, "{} is its own ancestor", node_label(document, static_cast<int>(i)));
    }
  }
}

/// Returns the root nodes of the shown scene.
std::vector<int> scene_roots(const Document& document, const std::vector<int>& parents) {
  const auto& model = document.model;
  std::vector<int> roots;
  if (model.scenes.empty()) {
    for (std::size_t i = 0; i < parents.size(); ++i) {
      if (parents[i] < 0) roots.push_back(static_cast<int>(i));
    }
    return roots;
  }
  const int shown = std::max(model.defaultScene, 0);
  roots = model.scenes[static_cast<std::size_t>(shown)].nodes;
  std::vector<bool> seen(parents.size(), false);
  for (const int root : roots) {
    const auto at = static_cast<std::size_t>(root);
    if (parents[at] >= 0) {
      fail(document.file, "scene {} lists {}, which is a child of node {}", shown,
           node_label(document, root), parents[at]);
    }
    if (seen[at]) fail(document.file, "scene {} lists {} twice", shown, node_label(document, root));
    seen[at] = true;
  }
  return roots;
}

/// glTF stores the columns of M in p' = M p. Read in the same order, they are the rows of our
/// matrix in p' = p M.
M44d given_matrix(const Document& document, int node, const std::vector<double>& m) {
  const bool affine = std::abs(m[3]) <= kAffineTolerance && std::abs(m[7]) <= kAffineTolerance &&
                      std::abs(m[11]) <= kAffineTolerance &&
                      std::abs(m[15] - 1.0) <= kAffineTolerance;
  if (!affine)
    fail(document.file, "{} has a matrix that is not affine", node_label(document, node));
  return M44d(m[0], m[1], m[2], 0, m[4], m[5], m[6], 0, m[8], m[9], m[10], 0, m[12], m[13], m[14],
              1);
}

V3d vector_or(const std::vector<double>& given, double value) {
  return given.size() == 3 ? V3d(given[0], given[1], given[2]) : V3d(value);
}

V4d rotation_of(const tinygltf::Node& node) {
  if (node.rotation.size() != 4) return {0, 0, 0, 1};
  return V4d(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]).normalized();
}

M44d local_matrix(const Document& document, int index, const Pose& pose) {
  static const NodePose kAtRest;
  const auto& node = document.model.nodes[static_cast<std::size_t>(index)];
  const auto moved = pose.find(index);
  const NodePose& now = moved == pose.end() ? kAtRest : moved->second;
  if (node.matrix.size() == 16) return given_matrix(document, index, node.matrix);
  return compose(now.translation.value_or(vector_or(node.translation, 0.0)),
                 now.rotation.value_or(rotation_of(node)),
                 now.scale.value_or(vector_or(node.scale, 1.0)));
}

void check_finite(const Document& document, const PlacedNode& placed) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (const auto& row : placed.to_world.x) {
    for (const double value : row) {
      if (std::abs(value) <= kLargest) continue;
      fail(document.file, "{} has a world matrix that is not finite",
           node_label(document, placed.node));
    }
  }
}

/// Returns the nodes at and below `roots`, depth first.
std::vector<PlacedNode> place_below(const Document& document, const std::vector<int>& roots,
                                    const Pose& pose) {
  std::vector<PlacedNode> open;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, M44d()});
  std::vector<PlacedNode> placed;
  while (!open.empty()) {
    PlacedNode at = open.back();  // to_world is still the parent's
    open.pop_back();
    at.to_world = local_matrix(document, at.node, pose) * at.to_world;
    check_finite(document, at);
    const auto& children = document.model.nodes[static_cast<std::size_t>(at.node)].children;
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      open.push_back({*child, at.to_world});
    }
    placed.push_back(at);
  }
  return placed;
}

}  // namespace

M44d compose(const V3d& translation, const V4d& rotation, const V3d& scale) {
  const Imath::Quatd quaternion(rotation.w, rotation.x, rotation.y, rotation.z);
  M44d matrix = quaternion.toMatrix44();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[row][column] *= scale[row];
    matrix[3][row] = translation[row];
  }
  return matrix;
}

std::vector<PlacedNode> place_nodes(const Document& document, const Pose& pose) {
  const std::vector<int> parents = find_parents(document);
  check_tree(document, parents);
  return place_below(document, scene_roots(document, parents), pose);
}

std::vector<M44d> world_matrices(const Document& document, const Pose& pose) {
  const std::vector<int> parents = find_parents(document);
  std::vector<int> roots;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] < 0) roots.push_back(static_cast<int>(i));
  }
  std::vector<M44d> matrices(parents.size());
  for (const PlacedNode& placed : place_below(document, roots, pose))
    matrices[static_cast<std::size_t>(placed.node)] = placed.to_world;
  return matrices;
}

}  // namespace dapple::gltf
