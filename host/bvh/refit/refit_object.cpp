#include "bvh/refit/refit_object.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bvh/build/quantize_boxes.hpp"
#include "bvh/refit/refit_subtree.hpp"

namespace dapple {
namespace {

/// A subtree has not moved rigidly if its layers_in() changed by more than this factor, up or down,
/// since it was last prefiltered.
constexpr float kRigidChange = 1.5f;

/// Number of subtrees per task.
constexpr std::size_t kGrain = 16;

bool is_alike(float now, float then) {
  constexpr float kNone = 1e-3f;  // below this, layers have no visible effect
  return (now <= kRigidChange * then && then <= kRigidChange * now) ||
         (now < kNone && then < kNone);
}

void set_boxes(BvhNode& node, const WideTree& tree, const WideNode& wide) {
  set_grid(node, wide.box);
  for (unsigned slot = 0; slot < wide.child_count; ++slot)
    set_child_box(node, slot, tree.children_of(wide)[slot].box);
}

class ObjectRefit : public SubtreeSummaries {
 public:
  ObjectRefit(const Mesh& mesh, const ObjectArrays& object,
              const std::function<const TextureIntegrals&()>& textures, RefitRecord& record)
      : mesh_(mesh),
        object_(object),
        textures_(textures),
        record_(record),
        subtree_(mesh, object, record),
        moved_(record.subtrees.size()),
        measured_(record.subtrees.size()) {}

  void refit(ObjectSummary& summary) {
    move_subtrees();
    move_upper_leaves();
    const double half_areas = move_upper_boxes();
    const WideTree& upper = record_.upper;
    summary.box = upper.nodes[0].box;
    summary.parts.clear();
    for (const WideChild& child : upper.children_of(upper.nodes[0]))
      summary.parts.push_back(child.box);
    summary.sah_cost = expected_visits(half_areas, summary.box);
    const bool needs_textures = find_deformed() || has_textured_leaves();
    const TextureIntegrals none;
    const TextureIntegrals& integrals = needs_textures ? textures_() : none;
    measure_deformed(integrals);
    const Summary all = prefilter({object_, upper, record_.upper_nodes, &record_, this}, integrals);
    const bool wall = summary.opacity.wall;
    summary.opacity = map_opacity(all.map, all.normals, summary.box);
    summary.opacity.wall = wall;
  }

  Summary summary(std::uint32_t node) const override {
    const std::size_t s = record_.subtree_at(record_.upper_nodes[node]);
    const MovedPart& moved = moved_[s];
    const KeptSubtree& kept = record_.subtrees[s];
    return {kept.map.with_means(kept.axes_at(layers_in(moved.areas, moved.box))), moved.normals,
            moved.areas};
  }

  const NodeOpacity* measured(std::uint32_t node) const override {
    const auto& found = measured_[record_.subtree_at(record_.upper_nodes[node])];
    return found ? &*found : nullptr;
  }

 private:
  template <class Body>
  void for_each_subtree(const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, record_.subtrees.size(), kGrain),
                      [&](const auto& range) {
                        for (std::size_t s = range.begin(); s < range.end(); ++s) body(s);
                      });
  }

  void move_subtrees() {
    for_each_subtree(
        [&](std::size_t s) { moved_[s] = subtree_.subtree(record_.subtrees[s].node); });
  }

  void move_upper_leaves() {
    WideTree& upper = record_.upper;
    tbb::parallel_for(std::size_t{0}, upper.nodes.size(), [&](std::size_t n) {
      const WideNode& wide = upper.nodes[n];
      if (wide.child_count == 0) return;
      const BvhNode& node = object_.nodes[record_.upper_nodes[n]];
      for (unsigned slot = 0; slot < wide.child_count; ++slot) {
        WideChild& child = upper.children[wide.first_child + slot];
        if (child.count > 0) child.box = subtree_.leaf(node, slot).box;
      }
    });
  }

  /// Computes the exact boxes bottom-up, then stores them in the nodes. Returns the sum of
  /// half_area() over all nodes.
  double move_upper_boxes() {
    WideTree& upper = record_.upper;
    double half_areas = 0;
    for (std::size_t n = upper.nodes.size(), s = moved_.size(); n-- > 0;) {
      if (upper.nodes[n].child_count > 0) continue;
      upper.nodes[n].box = moved_[--s].box;
      half_areas += moved_[s].half_areas;
    }
    pass_up_boxes(upper);
    for (const WideNode& node : upper.nodes)
      if (node.child_count > 0) half_areas += half_area(node.box);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, upper.nodes.size(), 256),
                      [&](const auto& range) {
                        for (std::size_t n = range.begin(); n < range.end(); ++n)
                          if (upper.nodes[n].child_count > 0)
                            set_boxes(object_.nodes[record_.upper_nodes[n]], upper, upper.nodes[n]);
                      });
    return half_areas;
  }

  /// Marks the subtrees that did not move rigidly. Returns whether there are any.
  bool find_deformed() {
    bool any = false;
    deformed_.assign(moved_.size(), 0);
    for (std::size_t s = 0; s < moved_.size(); ++s) {
      const V3f now = layers_in(moved_[s].areas, moved_[s].box), then = record_.subtrees[s].layers;
      for (int axis = 0; axis < 3; ++axis)
        if (!is_alike(now[axis], then[axis])) deformed_[s] = 1;
      any |= deformed_[s] != 0;
    }
    return any;
  }

  bool has_textured_leaves() const {
    for (std::size_t n = 0; n < record_.upper.nodes.size(); ++n) {
      const WideNode& wide = record_.upper.nodes[n];
      const BvhNode& node = object_.nodes[record_.upper_nodes[n]];
      const std::uint32_t end =
          wide.child_count > 0 ? bvh_leaf_end(node.leaf_end, DAPPLE_BVH_WIDTH - 1) : 0;
      for (std::uint32_t i = bvh_first_lane(node.prim_base); i < end; ++i)
        if (object_.blocks[bvh_block(node.prim_base, i)].opacity[i % 8] < 0.0f) return true;
    }
    return false;
  }

  void measure_deformed(const TextureIntegrals& integrals) {
    for_each_subtree([&](std::size_t s) {
      if (!deformed_[s]) return;
      KeptSubtree& kept = record_.subtrees[s];
      std::vector<std::uint32_t> node_of;
      const WideTree tree = wide_subtree(mesh_, object_, record_, kept.node, node_of);
      const Summary found = prefilter({object_, tree, node_of, &record_, nullptr}, integrals);
      const Box3f& box = tree.nodes[0].box;
      measured_[s] = map_opacity(found.map, found.normals, box);
      kept.keep(found.map, found.areas, box);
    });
  }

  const Mesh& mesh_;
  const ObjectArrays& object_;
  const std::function<const TextureIntegrals&()>& textures_;
  RefitRecord& record_;
  SubtreeRefit subtree_;
  std::vector<MovedPart> moved_;
  std::vector<std::uint8_t> deformed_;
  std::vector<std::optional<NodeOpacity>> measured_;
};

}  // namespace

void refit_object(const Mesh& mesh, const ObjectArrays& object,
                  const std::function<const TextureIntegrals&()>& textures, RefitRecord& record,
                  ObjectSummary& summary) {
  ObjectRefit(mesh, object, textures, record).refit(summary);
}

}  // namespace dapple
