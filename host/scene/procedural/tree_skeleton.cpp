// Grows branches towards points in the crown (Runions, Lane, Prusinkiewicz, Modeling Trees with a
// Space Colonization Algorithm, 2007), then computes their radii from the tips to the trunk.
// Lengths are relative to the tree's height until the end: see tree_skeleton.hpp.
#include "scene/procedural/tree_skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/procedural/pcg32.hpp"

namespace dapple {
namespace {

constexpr float kCrownBottom = 0.2f;
constexpr float kTrunkTop = 0.42f;  // above it there are only branches
constexpr float kStep = 0.021f;     // length of a branch segment
constexpr float kReached = 0.04f;   // an attractor this close to a branch is removed
constexpr float kTrunkRadius = 0.02f;
constexpr int kBoughs = 80;  // visibly separate clumps of foliage
constexpr int kAttractors = 1150;
constexpr std::size_t kMaxNodes = 20000;
constexpr int kMaxChildren = 3;

struct Attractor {
  V3f position;
  std::uint32_t nearest = 0;
  float distance2 = std::numeric_limits<float>::max();
};

struct Growth {
  TreeSkeleton tree;
  std::vector<std::uint32_t> last_child;  // of each node; 0 means none
  std::vector<int> child_count;

  void add(V3f position, std::uint32_t parent) {
    const auto node = static_cast<std::uint32_t>(tree.size());
    tree.positions.push_back(position);
    tree.parents.push_back(parent);
    last_child.push_back(0);
    child_count.push_back(0);
    if (node == parent) return;
    last_child[parent] = node;
    ++child_count[parent];
  }
};

// The distance of `point` from the axis, relative to the egg-shaped crown: 0 on the axis, 1 at the
// surface.
float crown_fraction(V3f point) {
  const float t = (point.y - kCrownBottom) / (1 - kCrownBottom);
  if (t <= 0 || t >= 1) return std::numeric_limits<float>::max();
  const float radius2 = kCrownRadius * kCrownRadius * 4 * t * (1 - t) * (1.35f - 0.75f * t);
  return std::sqrt((point.x * point.x + point.z * point.z) / radius2);
}

V3f point_in_crown(Pcg32& rng, float inner, float outer) {
  for (;;) {
    const V3f p = point_in_ball(rng);
    const V3f point(p.x * kCrownRadius * 1.1f,
                    kCrownBottom + (1 - kCrownBottom) * (0.5f + 0.5f * p.y),
                    p.z * kCrownRadius * 1.1f);
    const float fraction = crown_fraction(point);
    if (fraction >= inner && fraction <= outer) return point;
  }
}

// Attractors are grouped in boughs, most of them near the crown's surface. A uniform distribution
// would make the crown look like a ball.
std::vector<Attractor> scatter_attractors(Pcg32& rng) {
  std::vector<V3f> boughs;
  for (int i = 0; i < kBoughs; ++i) {
    boughs.push_back(point_in_crown(rng, i % 4 == 0 ? 0.0f : 0.5f, 0.85f));
  }
  std::vector<Attractor> attractors;
  while (attractors.size() < kAttractors) {
    const V3f centre = boughs[rng.below(kBoughs)];
    const V3f offset = point_in_ball(rng);
    const V3f position = centre + offset * V3f(0.1f, 0.06f, 0.1f);
    if (crown_fraction(position) <= 1) attractors.push_back({position});
  }
  return attractors;
}

void raise_trunk(Growth& growth, Pcg32& rng) {
  growth.add({0, 0, 0}, 0);
  V3f direction(0, 1, 0);
  while (growth.tree.positions.back().y < kTrunkTop) {
    const auto foot = static_cast<std::uint32_t>(growth.tree.size() - 1);
    growth.add(growth.tree.positions.back() + direction * kStep, foot);
    const V3f bend = unit_vector(rng);
    direction = (direction + bend * 0.12f + V3f(0, 0.12f, 0)).normalized();
  }
}

void find_nearest(std::vector<Attractor>& attractors, const TreeSkeleton& tree,
                  std::size_t first_node) {
  for (Attractor& attractor : attractors) {
    for (std::size_t node = first_node; node < tree.size(); ++node) {
      const float distance2 = (tree.positions[node] - attractor.position).length2();
      if (distance2 >= attractor.distance2) continue;
      attractor.distance2 = distance2;
      attractor.nearest = static_cast<std::uint32_t>(node);
    }
  }
}

// Whether a node must not get another child at `position`: it has three children, or its last child
// is very close. Otherwise a node between two attractors would get the same child again and again.
bool is_crowded(const Growth& growth, std::uint32_t node, V3f position) {
  if (growth.child_count[node] >= kMaxChildren) return true;
  if (growth.child_count[node] == 0) return false;
  const V3f sibling = growth.tree.positions[growth.last_child[node]];
  return (position - sibling).length2() < 0.25f * kStep * kStep;
}

V3f growth_direction(const TreeSkeleton& tree, std::uint32_t node, V3f pull, Pcg32& rng) {
  const V3f wander = unit_vector(rng);
  const V3f came_from = tree.positions[node] - tree.positions[tree.parents[node]];
  // The old direction and the upward direction have a part in the new one, so that branches bend
  // like those of a real tree.
  return (pull.normalized() + came_from.normalized() * 0.35f + V3f(0, 0.18f, 0) + wander * 0.22f)
      .normalized();
}

// Grows one step at every node that attractors pull on. Returns whether a node was added.
bool extend_branches(Growth& growth, const std::vector<Attractor>& attractors, Pcg32& rng) {
  const std::size_t count = growth.tree.size();
  std::vector<V3f> pulls(count, V3f(0, 0, 0));
  for (const Attractor& attractor : attractors) {
    pulls[attractor.nearest] +=
        (attractor.position - growth.tree.positions[attractor.nearest]).normalized();
  }
  for (std::uint32_t node = 0; node < count; ++node) {
    if (pulls[node].length2() < 1e-6f) continue;
    const V3f direction = growth_direction(growth.tree, node, pulls[node], rng);
    const V3f position = growth.tree.positions[node] + direction * kStep;
    if (!is_crowded(growth, node, position)) growth.add(position, node);
  }
  return growth.tree.size() > count;
}

// Computes radii: a branch's cross-section is the sum of its children's (da Vinci's rule). Nodes
// with a small cross-section become twigs.
void thicken(TreeSkeleton& tree) {
  std::vector<float> section(tree.size(), 0.0f);
  std::vector<bool> is_tip(tree.size(), true);
  for (std::size_t node = tree.size() - 1; node > 0; --node) {
    section[node] += is_tip[node] ? 1.0f : 0.12f;
    section[tree.parents[node]] += section[node];
    is_tip[tree.parents[node]] = false;
  }
  for (std::size_t node = 0; node < tree.size(); ++node) {
    const float flare = std::max(0.0f, 1 - tree.positions[node].y / 0.06f);
    tree.radii.push_back(kTrunkRadius * std::sqrt(section[node] / section[0]) *
                         (1 + 0.6f * flare * flare));
    if (node > 0 && section[node] < 3.5f) tree.twigs.push_back(static_cast<std::uint32_t>(node));
  }
}

}  // namespace

TreeSkeleton grow_skeleton(std::uint32_t seed, float height_m) {
  Pcg32 rng(seed, 0x736b656c65746f6eULL);  // a stream number above those of the leaves
  std::vector<Attractor> attractors = scatter_attractors(rng);
  Growth growth;
  raise_trunk(growth, rng);
  std::size_t grown_from = 0;
  do {
    find_nearest(attractors, growth.tree, grown_from);
    std::erase_if(attractors, [](const Attractor& a) { return a.distance2 < kReached * kReached; });
    grown_from = growth.tree.size();
  } while (grown_from < kMaxNodes && extend_branches(growth, attractors, rng));

  thicken(growth.tree);
  for (V3f& position : growth.tree.positions) position *= height_m;
  for (float& radius : growth.tree.radii) radius *= height_m;
  return std::move(growth.tree);
}

}  // namespace dapple
