// Finds what moved in a scene and updates its BVH: refits objects in place, rebuilds objects that
// cannot be refitted, and places the instances.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>

#include "bvh/build/joined_objects.hpp"
#include "bvh/build/scene_bvh.hpp"
#include "bvh/build/scene_objects.hpp"
#include "bvh/build/top_level.hpp"
#include "bvh/refit/refit_object.hpp"
#include "bvh/refit/texel_sizes.hpp"
#include "bvh/refit/traversal_cost.hpp"
#include "bvh/refit/vertex_places.hpp"
#include "bvh/storage/object_key.hpp"
#include "dapple/bvh.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

/// An object is rebuilt if its traversal_cost() exceeds that of its last build by this factor:
/// experiment 107.
constexpr double kWorstCost = 1.5;

/// A mesh as it was when its object was built.
struct MeshKey {
  Checksum form{}, positions{};
};

std::vector<MeshKey> keys_of(const Scene& scene) {
  std::vector<MeshKey> keys(scene.meshes.size());
  tbb::parallel_for(std::size_t{0}, 2 * keys.size(), [&](std::size_t i) {
    const Mesh& mesh = scene.meshes[i / 2];
    if (i % 2 == 0) keys[i / 2].form = form_key(scene, mesh);
    if (i % 2 == 1) keys[i / 2].positions = position_key(mesh);
  });
  return keys;
}

/// Returns the maximum number of top-level nodes: each node, except a single root, has at least two
/// instances below.
std::size_t max_top_nodes(const Scene& scene) { return scene.instances.size() + 1; }

bool is_placed_alike(const Instance& a, const Instance& b) {
  return a.mesh == b.mesh && a.light == b.light && a.to_world == b.to_world;
}

}  // namespace

struct UpdatableBvh::State {
  SceneBvh bvh;
  ChangeableArrays arrays;  ///< of `bvh`; empty until the first motion if none was expected
  std::vector<ObjectSummary> objects;
  std::vector<ObjectOffsets> offsets;
  std::vector<RefitRecord> records;  ///< one for each mesh; without nodes: there is no record
  std::vector<double> built_costs;   ///< of each object with a record, at its last build
  std::vector<double> built_places;  ///< the same: share_of_places()
  std::vector<MeshKey> keys;
  std::vector<Instance> instances;
  /// Of the textured triangles, from the first refit on: mip levels are the same in all poses.
  std::optional<TextureIntegrals> integrals;

  void build(const Scene& scene, Motion motion, const std::string& cache_folder);
  void rebuild(const Scene& scene, const std::vector<bool>& is_kept);
  void put_together(const Scene& scene, std::vector<FinishedObject> finished);
  void place(const Scene& scene, BvhUpdate& update);
  void update(const Scene& scene, const std::vector<MeshKey>& now, BvhUpdate& update);
  std::vector<std::size_t> sort_objects(const Scene& scene, const std::vector<MeshKey>& now,
                                        std::vector<bool>& is_kept) const;
  void refit(const Scene& scene, const std::vector<std::size_t>& moved);
  bool resize_texels(const Scene& scene, std::size_t mesh);
  [[nodiscard]] std::vector<FinishedObject> separated(const std::vector<bool>& is_kept) const;
  [[nodiscard]] bool can_refit(const Scene& scene, std::size_t mesh) const;
  [[nodiscard]] ObjectArrays arrays_of(std::size_t mesh) const;
};

void UpdatableBvh::State::build(const Scene& scene, Motion motion,
                                const std::string& cache_folder) {
  check_geometry(scene);
  const std::size_t meshes = scene.meshes.size();
  integrals.reset();
  bvh = {};
  arrays = {};
  objects.assign(meshes, {});
  offsets.assign(meshes + 1, {});
  records.assign(meshes, {});
  built_costs.assign(meshes, 0);
  built_places.assign(meshes, 1);
  if (motion == Motion::expected) return rebuild(scene, std::vector<bool>(meshes, false));
  BuiltScene built = build_scene(scene, cache_folder);
  bvh = std::move(built.bvh);
  objects = std::move(built.objects);
  offsets = std::move(built.offsets);
}

/// Builds all objects except those that are kept.
void UpdatableBvh::State::rebuild(const Scene& scene, const std::vector<bool>& is_kept) {
  integrals.reset();
  std::vector<FinishedObject> finished =
      build_refittable(scene, separated(is_kept), is_kept, records, bvh.statistics);
  put_together(scene, std::move(finished));
  tbb::parallel_for(std::size_t{0}, is_kept.size(), [&](std::size_t m) {
    if (is_kept[m] || !can_refit(scene, m)) return;
    built_costs[m] = traversal_cost(arrays_of(m).nodes, scene.meshes[m]);
    built_places[m] = share_of_places(scene.meshes[m].positions);
  });
}

/// Returns copies of the objects that are kept; the others are empty.
std::vector<FinishedObject> UpdatableBvh::State::separated(const std::vector<bool>& is_kept) const {
  std::vector<FinishedObject> finished(is_kept.size());
  for (std::size_t m = 0; m < is_kept.size(); ++m) {
    if (is_kept[m]) finished[m] = separate(bvh, objects[m], offsets[m], offsets[m + 1]);
  }
  return finished;
}

void UpdatableBvh::State::put_together(const Scene& scene, std::vector<FinishedObject> finished) {
  objects.assign(finished.begin(), finished.end());
  offsets = lay_out(finished, scene.source);
  arrays = join_changeable(bvh, finished, offsets, max_top_nodes(scene));
  BvhUpdate everything;
  place(scene, everything);
  bvh.statistics.lane_use = lane_use(bvh);
}

/// Builds the top level into the nodes reserved for it.
void UpdatableBvh::State::place(const Scene& scene, BvhUpdate& update) {
  describe_objects(bvh.statistics, objects);
  const LargeVector<BvhNode> top = place_instances(bvh, scene, objects, offsets);
  const std::size_t first = offsets.back().node;
  std::copy(top.begin(), top.end(), arrays.nodes.subspan(first).begin());
  if (!top.empty()) update.nodes.push_back({first, first + top.size()});
  update.placement = true;
}

bool UpdatableBvh::State::can_refit(const Scene& scene, std::size_t mesh) const {
  return !scene.meshes[mesh].has_strands() && !records[mesh].nodes.empty();
}

ObjectArrays UpdatableBvh::State::arrays_of(std::size_t mesh) const {
  const ObjectOffsets &first = offsets[mesh], &end = offsets[mesh + 1];
  return {arrays.nodes.subspan(first.node, end.node - first.node),
          arrays.blocks,
          bvh.textured,
          records[mesh].closed,
          first.node,
          first.block,
          first.textured};
}

/// Returns the objects that moved and can be refitted. Clears `is_kept` for the objects that must
/// be rebuilt.
std::vector<std::size_t> UpdatableBvh::State::sort_objects(const Scene& scene,
                                                           const std::vector<MeshKey>& now,
                                                           std::vector<bool>& is_kept) const {
  std::vector<std::size_t> moved;
  for (std::size_t m = 0; m < now.size(); ++m) {
    const bool has_its_form = now[m].form == keys[m].form;
    if (has_its_form && (now[m].positions == keys[m].positions || objects[m].box.isEmpty()))
      continue;
    is_kept[m] =
        has_its_form && can_refit(scene, m) &&
        std::fabs(share_of_places(scene.meshes[m].positions) - built_places[m]) < kOtherPlaces;
    if (is_kept[m]) moved.push_back(m);
  }
  return moved;
}

void UpdatableBvh::State::refit(const Scene& scene, const std::vector<std::size_t>& moved) {
  std::once_flag ready;
  const auto textures = [&]() -> const TextureIntegrals& {
    std::call_once(ready, [&] {
      if (integrals)
        integrals->move_to(scene);
      else
        integrals.emplace(scene, bvh.textured);
    });
    return *integrals;
  };
  tbb::parallel_for(std::size_t{0}, moved.size(), [&](std::size_t i) {
    const std::size_t m = moved[i];
    refit_object(scene.meshes[m], arrays_of(m), textures, records[m], objects[m]);
  });
}

/// Sets the sizes of texels on the mesh's triangles. Returns whether any changed.
bool UpdatableBvh::State::resize_texels(const Scene& scene, std::size_t mesh) {
  const ObjectOffsets &first = offsets[mesh], &end = offsets[mesh + 1];
  if (first.textured == end.textured) return false;
  const std::span<const std::uint32_t> lanes(bvh.primitives.begin(), bvh.primitives.size());
  return set_texel_sizes(scene, scene.meshes[mesh],
                         arrays.blocks.subspan(first.block, end.block - first.block),
                         lanes.subspan(first.lane(), end.lane() - first.lane()), arrays.textured);
}

void UpdatableBvh::State::update(const Scene& scene, const std::vector<MeshKey>& now,
                                 BvhUpdate& update) {
  std::vector<bool> is_kept(now.size(), true);
  const std::vector<std::size_t> moved = sort_objects(scene, now, is_kept);
  refit(scene, moved);
  for (const std::size_t m : moved) {
    const double cost = traversal_cost(arrays_of(m).nodes, scene.meshes[m]);
    const double ratio = built_costs[m] > 0 ? cost / built_costs[m] : 1;
    update.cost_ratio = std::max(update.cost_ratio, ratio);
    is_kept[m] = ratio <= kWorstCost;
    update.objects_refitted += is_kept[m];
    if (is_kept[m] && resize_texels(scene, m)) update.textured = true;
    update.nodes.push_back({offsets[m].node, offsets[m + 1].node});
    update.blocks.push_back({offsets[m].block, offsets[m + 1].block});
  }
  update.objects_rebuilt =
      static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), false));
  update.objects_kept = now.size() - update.objects_refitted - update.objects_rebuilt;
  const bool is_placed = std::equal(instances.begin(), instances.end(), scene.instances.begin(),
                                    scene.instances.end(), is_placed_alike);
  const std::size_t max_nodes = offsets.back().node + max_top_nodes(scene);
  if (update.objects_rebuilt > 0) {
    rebuild(scene, is_kept);
    update.is_new = true;
  } else if (!moved.empty() || !is_placed) {
    update.is_new = arrays.nodes.size() < max_nodes;
    if (update.is_new) put_together(scene, separated(is_kept));
    if (!update.is_new) place(scene, update);
  }
}

UpdatableBvh::UpdatableBvh(const Scene& scene, Motion motion, const std::string& cache_folder)
    : state_(std::make_unique<State>()) {
  state_->build(scene, motion, cache_folder);
  state_->keys = keys_of(scene);
  state_->instances = scene.instances;
}

UpdatableBvh::~UpdatableBvh() = default;
UpdatableBvh::UpdatableBvh(UpdatableBvh&&) noexcept = default;
UpdatableBvh& UpdatableBvh::operator=(UpdatableBvh&&) noexcept = default;

const SceneBvh& UpdatableBvh::bvh() const { return state_->bvh; }

BvhUpdate UpdatableBvh::update(const Scene& moved) {
  const auto start = std::chrono::steady_clock::now();
  BvhUpdate update;
  check_geometry(moved);
  std::vector<MeshKey> keys = keys_of(moved);
  try {
    if (keys.size() == state_->keys.size()) {
      state_->update(moved, keys, update);
    } else {
      state_->build(moved, Motion::expected, "");
      update.objects_rebuilt = keys.size();
      update.is_new = true;
    }
  } catch (...) {
    state_->keys.clear();  // the BVH is of no scene: the next update builds it anew
    throw;
  }
  state_->keys = std::move(keys);
  state_->instances = moved.instances;
  update.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return update;
}

}  // namespace dapple
