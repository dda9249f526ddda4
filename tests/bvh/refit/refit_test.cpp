// Compares refitted BVHs with newly built ones of the same moved scene: transmittances of rays,
// boxes and opacities. Also checks which bytes stay unchanged, and when an object is rebuilt.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>

#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/prefilter.hpp"
#include "support/failing_opencl.hpp"
#include "support/scenes/scattered_tree.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/swaying_tree.hpp"

namespace dapple {
namespace {

using motion::swayed;
using scene_test::place;
using scene_test::square_mesh;

template <class Array>
std::string bytes_of(const Array& values, std::size_t begin, std::size_t end) {
  return {reinterpret_cast<const char*>(values.data() + begin), (end - begin) * sizeof(values[0])};
}

template <class Array>
std::string bytes_of(const Array& values) {
  return bytes_of(values, 0, values.size());
}

Scene tree(int leaves = 5000) {
  return make_procedural("scene:tree?leaves=" + std::to_string(leaves));
}

/// Bounds of the triangles in the lanes [begin, end) of a node. Each of its blocks has eight lanes.
Box3f leaf_box(const SceneBvh& bvh, const BvhNode& node, std::uint32_t begin, std::uint32_t end) {
  Box3f box;
  for (std::uint32_t i = begin; i < end; ++i) {
    const TriangleBlock& block = bvh.blocks[bvh_block(node.prim_base, i)];
    for (unsigned corner = 0; corner < 3; ++corner) box.extendBy(corner_of(block, corner, i % 8));
  }
  return box;
}

/// Expects that `outer` contains `inner`, except for the rounding of edges.
void expect_inside(const Box3f& outer, const Box3f& inner) {
  for (int axis = 0; axis < 3; ++axis) {
    const float slack = 1e-5f * (1 + std::fabs(inner.min[axis]) + std::fabs(inner.max[axis]));
    EXPECT_LE(outer.min[axis], inner.min[axis] + slack);
    EXPECT_GE(outer.max[axis], inner.max[axis] - slack);
  }
}

/// Checks all boxes below an object's node. Returns the bounds of its triangles, and counts them.
Box3f check_boxes(const SceneBvh& bvh, std::uint32_t index, std::size_t& triangles) {
  const BvhNode& node = bvh.nodes[index];
  Box3f all;
  std::uint32_t inner = node.child_base;
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    const std::uint32_t begin = bvh_leaf_begin(&node, slot),
                        end = bvh_leaf_end(node.leaf_end, slot);
    const bool is_inner = (node.inner_mask >> slot & 1u) != 0;
    if (!is_inner && begin == end) continue;
    const Box3f box =
        is_inner ? check_boxes(bvh, inner++, triangles) : leaf_box(bvh, node, begin, end);
    triangles += is_inner ? 0 : end - begin;
    expect_inside(child_box(node, slot), box);
    all.extendBy(box);
  }
  return all;
}

/// Expects that exact rays through the updated scene have the transmittances of a newly built one.
void expect_fresh_transmittances(const Device& device, const DeviceScene& updated,
                                 const Scene& moved, std::size_t count) {
  const scene_test::SceneOnDevice fresh(moved);
  const auto rays = scene_test::rays_through(fresh.bvh.bounds, count, 30, 0, 7);
  const auto found = trace(device, updated, rays, Estimator::exact);
  const auto expected = fresh.trace(rays, Estimator::exact);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_NEAR(found[i].transmittance, expected[i].transmittance, 1e-5f) << "ray " << i;
}

TEST(Refit, BoxesContainTheMovedTriangles) {
  const Scene still = tree();
  UpdatableBvh updatable(still);
  const Scene moved = swayed(still, 1.3f, 2);
  const BvhUpdate update = updatable.update(moved);
  EXPECT_EQ(update.objects_refitted, 1u);
  EXPECT_FALSE(update.is_new);
  std::size_t triangles = 0;
  const Box3f all = check_boxes(updatable.bvh(), updatable.bvh().root, triangles);
  EXPECT_EQ(triangles, moved.meshes[0].primitive_count());
  expect_inside(updatable.bvh().bounds, all);
  EXPECT_EQ(updatable.bvh().bounds, build_bvh(moved).bounds);
}

TEST(Refit, EveryExactRayIntersectsWhatItIntersectsInAFreshBvh) {
  const Scene still = tree();
  UpdatableBvh updatable(still);
  const Device& device = scene_test::device();
  DeviceScene on_device = upload(device, still, updatable.bvh());
  for (const float time : {0.4f, 1.2f, 2.9f}) {
    const Scene moved = swayed(still, time, 1.5f);
    update(device, on_device, updatable, moved);
    expect_fresh_transmittances(device, on_device, moved, 20000);
  }
}

// As an Error while a scene is uploaded anew leaves it.
TEST(Refit, ASceneThatIsNotOnTheDeviceIsUploaded) {
  const Scene still = tree(), moved = swayed(still, 1.2f, 1.5f);
  UpdatableBvh updatable(still);
  DeviceScene on_device;
  update(scene_test::device(), on_device, updatable, moved);
  expect_fresh_transmittances(scene_test::device(), on_device, moved, 5000);
}

// The device has its own memory, not shared with the host.
TEST(Refit, OnlyWhatMovedIsUploaded) {
  opencl_test::pretend_own_memory(true);
  const Device device;
  opencl_test::pretend_own_memory(false);
  Scene still = tree(20000);
  place(still, square_mesh(3, 1, 12, 0), M44f().setTranslation(V3f(9, 0, 0)));
  UpdatableBvh updatable(still);
  DeviceScene on_device = upload(device, still, updatable.bvh());
  Scene moved = still;
  for (V3f& p : moved.meshes[1].positions) p.y += 0.2f * p.x;
  const std::size_t before = opencl_test::written_bytes();
  const BvhUpdate changes = update(device, on_device, updatable, moved);
  const std::size_t written = opencl_test::written_bytes() - before;
  EXPECT_EQ(changes.objects_refitted, 1u);
  EXPECT_GT(written, 288u * 40);
  EXPECT_LT(written, on_device.bytes / 20);
  expect_fresh_transmittances(device, on_device, moved, 5000);
}

// Refitting keeps some opacities and does not compute them again. They must be those of a build.
TEST(Refit, OpacitiesOfWhatMovedBackAreThoseOfTheBuild) {
  const Scene still = tree();
  UpdatableBvh updatable(still);
  updatable.update(swayed(still, 1));
  updatable.update(still);
  const SceneBvh &refitted = updatable.bvh(), fresh = build_bvh(still);
  double sum = 0, max = 0, count = 0;
  for (std::size_t n = 0; n < fresh.nodes.size(); ++n) {
    const BvhNode &a = refitted.nodes[n], &b = fresh.nodes[n];
    EXPECT_EQ(std::memcmp(a.lower, b.lower, sizeof a.lower), 0);
    EXPECT_EQ(std::memcmp(a.upper, b.upper, sizeof a.upper), 0);
    for (int axis = 0; axis < 3; ++axis) {
      for (int slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
        const double off = a.depth[axis][slot] - b.depth[axis][slot];
        sum += off;
        max = std::max(max, std::fabs(off));
        ++count;
      }
    }
  }
  std::printf("depth codes off by %.4f in the mean, %.0f at most\n", sum / count, max);
  EXPECT_NEAR(sum / count, 0, 0.1);
  EXPECT_LE(max, 8);
}

TEST(Refit, ThreadsDontChangeABit) {
  const Scene still = tree();
  const Scene moved = swayed(still, 0.7f, 2);
  std::string one_thread;
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    UpdatableBvh updatable(still);
    updatable.update(moved);
    one_thread = bytes_of(updatable.bvh().nodes) + bytes_of(updatable.bvh().blocks);
  }
  UpdatableBvh updatable(still);
  updatable.update(moved);
  EXPECT_EQ(bytes_of(updatable.bvh().nodes) + bytes_of(updatable.bvh().blocks), one_thread);
}

/// A tree that may sway, beside a fence that never moves. Both have two instances.
Scene tree_and_fence() {
  Scene scene = tree(2000);
  place(scene, square_mesh(3, 1, 12, 0), M44f().setTranslation(V3f(9, 0, 0)));
  for (int i = 0; i < 2; ++i)
    scene.instances.push_back(
        {static_cast<std::uint32_t>(i), M44f().setTranslation(V3f(20, 0, 10)), -1});
  return scene;
}

TEST(Refit, ObjectsThatDidNotMoveKeepTheirBytes) {
  const Scene still = tree_and_fence();
  UpdatableBvh updatable(still);
  const std::string nodes = bytes_of(updatable.bvh().nodes),
                    blocks = bytes_of(updatable.bvh().blocks);
  const BvhUpdate update = updatable.update(swayed(still, 1));
  EXPECT_EQ(update.objects_refitted, 1u);
  EXPECT_EQ(update.objects_kept, 1u);
  ASSERT_EQ(update.blocks.size(), 1u);
  const auto is_changed = [](const std::vector<IndexRange>& ranges, std::size_t i) {
    return std::any_of(ranges.begin(), ranges.end(),
                       [&](const IndexRange& r) { return i >= r.begin && i < r.end; });
  };
  const SceneBvh& bvh = updatable.bvh();
  std::size_t kept = 0;
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
    if (is_changed(update.nodes, n)) continue;
    ++kept;
    EXPECT_EQ(bytes_of(bvh.nodes, n, n + 1), nodes.substr(n * sizeof(BvhNode), sizeof(BvhNode)));
  }
  for (std::size_t b = 0; b < bvh.blocks.size(); ++b) {
    if (is_changed(update.blocks, b)) continue;
    ++kept;
    EXPECT_EQ(bytes_of(bvh.blocks, b, b + 1),
              blocks.substr(b * sizeof(TriangleBlock), sizeof(TriangleBlock)));
  }
  EXPECT_GT(kept, 288u / 8);
}

TEST(Refit, InstancesThatMoveTouchTheTopLevelOnly) {
  Scene scene = tree_and_fence();
  UpdatableBvh updatable(scene);
  const std::string blocks = bytes_of(updatable.bvh().blocks);
  scene.instances[2].to_world.setTranslation(V3f(-30, 2, 5));
  const BvhUpdate update = updatable.update(scene);
  EXPECT_EQ(update.objects_kept, 2u);
  EXPECT_TRUE(update.placement);
  EXPECT_FALSE(update.is_new);
  EXPECT_TRUE(update.blocks.empty());
  ASSERT_EQ(update.nodes.size(), 1u);
  EXPECT_EQ(update.nodes[0].begin, updatable.bvh().root);
  EXPECT_EQ(bytes_of(updatable.bvh().blocks), blocks);
  const SceneBvh fresh = build_bvh(scene);
  EXPECT_EQ(bytes_of(updatable.bvh().nodes, 0, fresh.nodes.size()), bytes_of(fresh.nodes));
  EXPECT_EQ(bytes_of(updatable.bvh().instances), bytes_of(fresh.instances));
}

TEST(Refit, AnUnchangedSceneChangesNothing) {
  const Scene scene = tree_and_fence();
  UpdatableBvh updatable(scene);
  const BvhUpdate update = updatable.update(scene);
  EXPECT_EQ(update.objects_kept, 2u);
  EXPECT_FALSE(update.is_new || update.placement);
  EXPECT_TRUE(update.nodes.empty() && update.blocks.empty());
}

TEST(Refit, AnObjectWhoseTreeHasDecayedIsBuiltAnew) {
  const Scene still = tree_and_fence();
  UpdatableBvh updatable(still);
  const Scene moved = motion::scattered(still, 5);
  const BvhUpdate update = updatable.update(moved);
  EXPECT_EQ(update.objects_rebuilt, 1u);
  EXPECT_EQ(update.objects_kept, 1u);
  EXPECT_GT(update.cost_ratio, 1.5);
  EXPECT_TRUE(update.is_new);
  const SceneBvh fresh = build_bvh(moved);
  EXPECT_EQ(bytes_of(updatable.bvh().nodes, 0, fresh.nodes.size()), bytes_of(fresh.nodes));
  EXPECT_EQ(bytes_of(updatable.bvh().blocks), bytes_of(fresh.blocks));
  // Later motion refits the rebuilt object.
  EXPECT_EQ(updatable.update(swayed(moved, 0.1f, 0.2f)).objects_refitted, 1u);
}

TEST(Refit, AnObjectWithAnotherNumberOfTrianglesIsBuiltAnew) {
  Scene scene = tree_and_fence();
  UpdatableBvh updatable(scene);
  scene.meshes[0].indices.resize(scene.meshes[0].indices.size() - 30);
  scene.meshes[0].materials.resize(scene.meshes[0].materials.size() - 10);
  const BvhUpdate update = updatable.update(scene);
  EXPECT_EQ(update.objects_rebuilt, 1u);
  EXPECT_EQ(update.objects_kept, 1u);
  EXPECT_EQ(bytes_of(updatable.bvh().blocks), bytes_of(build_bvh(scene).blocks));
}

TEST(Refit, MotionThatWasNotExpectedIsBuiltOnceAndRefittedFromThenOn) {
  const Scene still = tree(2000);
  UpdatableBvh updatable(still, UpdatableBvh::Motion::maybe);
  EXPECT_EQ(bytes_of(updatable.bvh().nodes), bytes_of(build_bvh(still).nodes));
  EXPECT_EQ(updatable.update(still).objects_kept, 1u);
  EXPECT_EQ(updatable.update(swayed(still, 1)).objects_rebuilt, 1u);
  EXPECT_EQ(updatable.update(swayed(still, 1.1f)).objects_refitted, 1u);
}

/// Cards that a texture cuts out. `lean` moves their vertices along +X: those of higher cards more,
/// and the upper vertices of a card more than the lower ones.
Scene cards(float lean) {
  Scene scene = make_procedural("scene:tree?leaves=10");
  scene.meshes.clear();
  scene.instances.clear();
  Texture texture;
  texture.width = texture.height = 8;
  for (unsigned i = 0; i < 64; ++i) texture.alpha.push_back((i / 2 + i / 16) % 2 ? 255 : 0);
  scene.textures = {texture};
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_texture = 0;
  scene.materials = {material};
  Mesh mesh;
  scene_test::Points points(5);
  for (int card = 0; card < 600; ++card) {
    const V3f foot = points.in_cube(3), side = points.on_sphere(), up = points.on_sphere();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 4; ++k) {
      const auto u = static_cast<float>(k & 1), v = static_cast<float>(k / 2);
      mesh.positions.push_back(foot + side * (0.5f * u) + up * (0.5f * v) +
                               V3f(lean * (v + foot.y), 0, 0));
      mesh.uvs.emplace_back(u, v);
    }
    mesh.indices.insert(mesh.indices.end(),
                        {first, first + 1, first + 3, first, first + 3, first + 2});
    mesh.materials.insert(mesh.materials.end(), {0, 0});
  }
  place(scene, std::move(mesh));
  return scene;
}

// What is stored of a triangle besides its corners is the size of a texel.
TEST(Refit, TexelsGrowWithTheirTriangles) {
  UpdatableBvh updatable(cards(0));
  const std::string records = bytes_of(updatable.bvh().textured);
  Scene large = cards(0);
  for (V3f& p : large.meshes[0].positions) p *= 50.0f;
  const BvhUpdate update = updatable.update(large);
  EXPECT_EQ(update.objects_refitted, 1u);
  EXPECT_TRUE(update.textured);
  EXPECT_EQ(bytes_of(updatable.bvh().textured), bytes_of(build_bvh(large).textured));
  EXPECT_TRUE(updatable.update(cards(0)).textured);
  EXPECT_EQ(bytes_of(updatable.bvh().textured), records);
}

TEST(Refit, TexturedTrianglesKeepTheirTexture) {
  UpdatableBvh updatable(cards(0));
  ASSERT_EQ(updatable.bvh().textured.size(), 1200u);
  const Scene moved = cards(0.15f);
  EXPECT_EQ(updatable.update(moved).objects_refitted, 1u);
  const Device& device = scene_test::device();
  const DeviceScene on_device = upload(device, moved, updatable.bvh());
  const scene_test::SceneOnDevice fresh(moved);
  EXPECT_EQ(bytes_of(updatable.bvh().textured), bytes_of(fresh.bvh.textured));
  const auto rays = scene_test::rays_through(fresh.bvh.bounds, 20000, 10, 0.05f, 11);
  const auto found = trace(device, on_device, rays, Estimator::exact);
  const auto expected = fresh.trace(rays, Estimator::exact);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_NEAR(found[i].transmittance, expected[i].transmittance, 1e-5f) << "ray " << i;
  const auto mean = [](const std::vector<Occlusion>& values) {
    return scene_test::mean_transmittance(values);
  };
  const double exact = mean(expected),
               refitted = mean(trace(device, on_device, rays, Estimator::prefiltered)),
               built = mean(fresh.trace(rays, Estimator::prefiltered));
  std::printf("transmittance exact %.4f, prefiltered and refitted %.4f, fresh %.4f\n", exact,
              refitted, built);
  EXPECT_NEAR(refitted, built, 0.01);
}

template <class T>
double bytes_in(const std::vector<T>& values) {
  return static_cast<double>(values.size() * sizeof(T));
}

TEST(Refit, RecordsTakeLessThanTwentyBytesPerTriangle) {
  const Scene scene = tree(50000);
  BuiltObject built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]);
  RefitRecord record;
  prefilter(built, TextureIntegrals(scene, built.object.textured), &record);
  const double bytes = bytes_in(record.triangles) + bytes_in(record.closed) +
                       bytes_in(record.textured_opacity) + bytes_in(record.nodes) +
                       bytes_in(record.subtrees) + bytes_in(record.upper.nodes) +
                       bytes_in(record.upper.children) + bytes_in(record.upper_nodes);
  const double each = bytes / static_cast<double>(built.object.primitive_count);
  std::printf("%.1f bytes a triangle\n", each);
  EXPECT_LT(each, 20);
}

}  // namespace
}  // namespace dapple
