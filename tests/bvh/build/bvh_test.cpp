// BVHs of objects, and the top level over instances: every triangle is in one lane, boxes contain
// their content, indices are in order, and the bits do not depend on the number of threads.
// Degenerate geometry also gives a well-formed BVH.
#include "dapple/bvh.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "dapple/error.hpp"
#include "support/same_bits.hpp"

namespace dapple {
namespace {

using Corners = std::array<V3f, 3>;

Scene scene_of(const std::vector<Corners>& triangles, float alpha = 1.0f) {
  Scene scene;
  scene.source = "test";
  Material material;
  material.alpha_mode = AlphaMode::blend;
  material.alpha = alpha;
  scene.materials.push_back(material);
  Mesh mesh;
  for (const Corners& corners : triangles) {
    for (const V3f& p : corners) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
    mesh.materials.push_back(0);
  }
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, M44f(), -1});
  return scene;
}

Corners triangle_at(const V3f& p, float size) {
  return {p, p + V3f(size, 0, 0), p + V3f(0, size, size)};
}

std::vector<Corners> random_triangles(std::size_t count, float size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-1, 1);
  const auto vector = [&] {
    V3f v;
    for (int a = 0; a < 3; ++a) v[a] = at(random);
    return v;
  };
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const V3f p = vector();
    triangles.push_back({p, p + vector() * size, p + vector() * size});
  }
  return triangles;
}

/// Visits an object's nodes as a kernel does, and checks everything that kernels rely on.
class Walk {
 public:
  Walk(const Mesh& mesh, const ObjectBvh& object) : mesh_(mesh), object_(object) {
    for (std::uint32_t t = 0; t < mesh.primitive_count(); ++t)
      triangles_of_lane_[lane_of(t)].push_back(t);
    visits_.resize(object.nodes.size(), 0);
    is_used_.resize(8 * object.blocks.size(), false);
  }

  void run() {
    const Box3f box = node(0);
    EXPECT_EQ(box, object_.box);
    check_unused_lanes();
    for (std::size_t n = 0; n < visits_.size(); ++n) {
      ASSERT_EQ(visits_[n], 1) << "visits of node " << n;
    }
  }

  /// Triangles of the mesh that no lane holds.
  [[nodiscard]] std::vector<std::uint32_t> missing() const {
    std::vector<std::uint32_t> left;
    for (const auto& [lane, triangles] : triangles_of_lane_) {
      left.insert(left.end(), triangles.begin(), triangles.end());
    }
    return left;
  }

 private:
  using Lane = std::array<float, 9>;

  const V3f& corner(std::uint32_t triangle, int c) const {
    return mesh_.positions[mesh_.indices[3 * std::size_t{triangle} + c]];
  }

  Lane lane_of(std::uint32_t t) const {
    const V3f a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    return {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
  }

  static Lane lane_of(const TriangleBlock& block, unsigned lane) {
    Lane values;
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        values[3 * corner + axis] = block.vertex[corner][axis][lane];
    return values;
  }

  /// Checks node `index` and the nodes below it. Returns the exact box of their triangles.
  Box3f node(std::uint32_t index) {
    const BvhNode& n = object_.nodes[index];
    ++visits_[index];
    Box3f box;
    std::uint32_t inner = 0;
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      const std::uint32_t begin = bvh_leaf_begin(&n, slot), end = bvh_leaf_end(n.leaf_end, slot);
      EXPECT_LE(begin, end);
      const bool is_inner = n.inner_mask >> slot & 1;
      if (n.lower[0][slot] > n.upper[0][slot]) {
        EXPECT_FALSE(is_inner) << "an empty slot is inner";
        EXPECT_EQ(begin, end) << "an empty slot owns triangles";
        continue;
      }
      Box3f child;
      if (is_inner) {
        EXPECT_EQ(begin, end) << "an inner slot owns triangles";
        const std::uint32_t child_index = n.child_base + inner++;
        EXPECT_GT(child_index, index);
        if (child_index <= index || child_index >= object_.nodes.size()) continue;
        child = node(child_index);
      } else {
        EXPECT_LT(begin, end) << "a leaf without triangles";
        for (std::uint32_t i = begin; i < end; ++i) child.extendBy(take(n.prim_base, i));
      }
      const Box3f grown = child_box(n, slot);
      EXPECT_TRUE(grown.intersects(child.min) && grown.intersects(child.max))
          << "slot " << slot << " of node " << index << " does not contain its triangles";
      box.extendBy(child);
    }
    const std::uint32_t own = bvh_leaf_end(n.leaf_end, DAPPLE_BVH_WIDTH - 1),
                        first = bvh_first_lane(n.prim_base);
    EXPECT_LE((own + 7) / 8, (own - first + 7) / 8) << "more blocks than triangles need";
    return box;
  }

  /// Returns the box of the triangle in lane `i`, and removes the triangle from those still
  /// missing.
  Box3f take(std::uint32_t prim_base, std::uint32_t i) {
    const std::uint32_t block = bvh_block(prim_base, i);
    Box3f box;
    EXPECT_LT(block, object_.blocks.size());
    if (block >= object_.blocks.size()) return box;
    EXPECT_FALSE(is_used_[8 * std::size_t{block} + i % 8]) << "two nodes own a lane";
    is_used_[8 * std::size_t{block} + i % 8] = true;
    auto& triangles = triangles_of_lane_[lane_of(object_.blocks[block], i % 8)];
    EXPECT_FALSE(triangles.empty()) << "a lane holds no triangle of the mesh, or one twice";
    if (triangles.empty()) return box;
    for (int c = 0; c < 3; ++c) box.extendBy(corner(triangles.back(), c));
    triangles.pop_back();
    return box;
  }

  void check_unused_lanes() const {
    for (std::size_t lane = 0; lane < is_used_.size(); ++lane) {
      EXPECT_EQ(is_used_[lane], object_.primitives[lane] != kNoPrimitive);
      if (is_used_[lane]) continue;
      const TriangleBlock& block = object_.blocks[lane / 8];
      const Lane values = lane_of(block, lane % 8);
      EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return v == 0; }));
      EXPECT_EQ(block.opacity[lane % 8], 0.0f);
    }
  }

  const Mesh& mesh_;
  const ObjectBvh& object_;
  std::map<Lane, std::vector<std::uint32_t>> triangles_of_lane_;
  std::vector<int> visits_;
  std::vector<bool> is_used_;  ///< lanes
};

ObjectBvh expect_well_formed(const Scene& scene) {
  const ObjectBvh object = build_object(scene, OpaqueTexels(scene), scene.meshes[0]).object;
  EXPECT_EQ(object.primitive_count, scene.meshes[0].primitive_count());
  Walk walk(scene.meshes[0], object);
  walk.run();
  EXPECT_TRUE(walk.missing().empty());
  return object;
}

TEST(Bvh, EveryTriangleIsInOneLaneInsideItsBoxesAndIndicesAreInOrder) {
  for (const std::size_t count : {1, 2, 3, 4, 5, 8, 9, 33, 1000, 20000}) {
    SCOPED_TRACE(count);
    for (const float size : {0.05f, 1.0f})
      expect_well_formed(scene_of(random_triangles(count, size)));
  }
}

TEST(Bvh, DegenerateGeometryMakesAWellFormedTree) {
  std::map<std::string, std::vector<Corners>> cases;
  cases["two equal"] = {2, triangle_at({1, 2, 3}, 1)};
  cases["10,000 identical"] = {10000, triangle_at({1, 2, 3}, 1)};
  for (int i = 0; i < 5000; ++i) {
    const float x = static_cast<float>(i);
    cases["centres in a line"].push_back(triangle_at({x * 0.01f, 0, 0}, 0.1f));
    // Triangles that grow around one point: the centres of all boxes are equal, the boxes differ.
    cases["concentric"].push_back({V3f(-x, -x, 0), V3f(x, -x, 0), V3f(0, x, 0)});
    // Scales from 1e-6 to 1e6 in 5,000 equal ratios, which binned splits divide into very unequal
    // parts.
    const float scale = std::pow(10.0f, -6.0f + 12.0f * x / 5000.0f);
    cases["of all scales, in a row"].push_back(triangle_at({scale, 0, 0}, 0.1f * scale));
    cases["of all scales, in space"].push_back(
        triangle_at(V3f(scale, i % 2 ? scale : -scale, i % 3 ? scale : 0), 0.1f * scale));
    cases["points"].push_back({V3f(x, 0, 0), V3f(x, 0, 0), V3f(x, 0, 0)});
    cases["far and small"].push_back(triangle_at({1e6f + x, 1e6f, 1e6f}, 1e-3f));
    cases["denormal"].push_back(triangle_at({x * 1e-42f, 0, 0}, 1e-42f));
  }
  for (const auto& [name, triangles] : cases) {
    SCOPED_TRACE(name);
    const Scene scene = scene_of(triangles);
    const ObjectBvh object = expect_well_formed(scene);
    EXPECT_LE(object.stack, DAPPLE_STACK_SIZE);
    EXPECT_EQ(build_bvh(scene).nodes.size(), object.nodes.size());
    for (int a = 0; a < 3; ++a) {
      EXPECT_TRUE(object.opacity.axes[a] >= 0 && object.opacity.axes[a] <= 1)
          << object.opacity.axes[a];
    }
  }
}

TEST(Bvh, OneThreadAndFourMakeTheSameBits) {
  // More than 65,536 triangles, so that binning is parallel too. Two instances give a top level.
  Scene scene = scene_of(random_triangles(70000, 0.05f), 0.4f);
  scene.instances.push_back({0, M44f().setTranslation(V3f(1, 2, 0.5f)), -1});
  const auto build = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return build_bvh(scene);
  };
  const SceneBvh one = build(1), four = build(4);
  EXPECT_TRUE(same_bits(one.nodes, four.nodes));
  EXPECT_TRUE(same_bits(one.blocks, four.blocks));
  EXPECT_TRUE(same_bits(one.instances, four.instances));
}

TEST(Bvh, NodesAndBlocksAreFewerThanHalfTheTriangles) {
  // The limit must hold for several counts, since the lowest level of eight-wide nodes is not
  // equally full for all of them.
  for (const std::size_t count : {3000, 10000, 30000, 100000}) {
    const float spacing = 2 / std::cbrt(static_cast<float>(count));
    const Scene scene = scene_of(random_triangles(count, 0.2f * spacing));
    const ObjectBvh object = build_object(scene, OpaqueTexels(scene), scene.meshes[0]).object;
    EXPECT_LT(2 * object.nodes.size(), count);
    EXPECT_LT(2 * object.blocks.size(), count);
  }
}

TEST(Bvh, FullyTransparentTrianglesAreDropped) {
  Scene scene = scene_of(random_triangles(300, 0.2f), 0.5f);
  Material clear = scene.materials[0], below_cutoff = clear;
  clear.alpha = 0;
  below_cutoff.alpha_mode = AlphaMode::mask;
  below_cutoff.alpha = 0.4f;
  scene.materials.push_back(clear);
  scene.materials.push_back(below_cutoff);
  for (std::uint32_t t = 0; t < 300; ++t) scene.meshes[0].materials[t] = t % 3;
  const ObjectBvh object = build_object(scene, OpaqueTexels(scene), scene.meshes[0]).object;
  EXPECT_EQ(object.primitive_count, 100u);
  EXPECT_EQ(object.translucent, 100u);
  Walk walk(scene.meshes[0], object);
  walk.run();
  const auto missing = walk.missing();
  EXPECT_EQ(missing.size(), 200u);
  for (const std::uint32_t t : missing) EXPECT_NE(t % 3, 0u);
}

TEST(Bvh, ASceneThatNothingCanHitIsAnInputErrorNamingIt) {
  try {
    build_bvh(scene_of(random_triangles(10, 1), 0));
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(std::string(error.what()).rfind("test: ", 0), 0u) << error.what();
  }
}

/// Instances with random affine matrices, some of them mirrored or sheared.
Scene scattered_scene(int count) {
  Scene scene = scene_of(random_triangles(50, 0.5f));
  scene.instances.clear();
  std::mt19937 random(9);
  std::uniform_real_distribution<float> at(-1, 1);
  while (static_cast<int>(scene.instances.size()) < count) {
    M44f m;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 3; ++column) m[row][column] = (row == 3 ? 20 : 1) * at(random);
    }
    if (std::fabs(m.determinant()) > 0.05f) scene.instances.push_back({0, m, -1});
  }
  return scene;
}

/// Returns the exact world box of the instances below top-level node `index`. Checks that each box
/// is inside of its slot, and counts in `found` how often each instance was found.
Box3f walk_top(const SceneBvh& bvh, const Mesh& mesh, std::uint32_t index,
               std::vector<int>& found) {
  const BvhNode& n = bvh.nodes[index];
  Box3f box;
  for (unsigned slot = 0, inner = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    if (n.lower[0][slot] > n.upper[0][slot]) continue;
    Box3f child;
    if (n.inner_mask >> slot & 1) {
      child = walk_top(bvh, mesh, n.child_base + inner++, found);
    } else {
      EXPECT_EQ(bvh_leaf_end(n.leaf_end, slot), bvh_leaf_begin(&n, slot) + 1);
      const std::uint32_t instance = n.prim_base + bvh_leaf_end(n.leaf_end, slot) - 1u;
      ++found.at(instance);
      const float* m = bvh.instances[instance].to_world;
      for (const V3f& p : mesh.positions) {
        const auto row = [&](int r) {
          return m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3];
        };
        child.extendBy(V3f(row(0), row(1), row(2)));
      }
    }
    const Box3f grown = child_box(n, slot);
    for (int a = 0; a < 3; ++a) {
      // Both sides round a sum of four terms below 25; 1e-5 is a few spacings of such floats.
      EXPECT_LE(grown.min[a], child.min[a] + 1e-5f);
      EXPECT_GE(grown.max[a], child.max[a] - 1e-5f);
    }
    box.extendBy(child);
  }
  return box;
}

TEST(Bvh, TheTopLevelHoldsEveryInstanceOnceWithInverseMatrices) {
  const Scene scene = scattered_scene(200);
  const SceneBvh bvh = build_bvh(scene);
  ASSERT_TRUE(bvh.has_top);
  ASSERT_EQ(bvh.instances.size(), 200u);
  std::vector<int> found(200, 0);
  walk_top(bvh, scene.meshes[0], bvh.root, found);
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](int count) { return count == 1; }));
  EXPECT_EQ(bvh.statistics.instanced_triangles, 200u * 50u);
  EXPECT_EQ(bvh.statistics.triangles, 50u);
  for (const InstanceRecord& record : bvh.instances) {
    const auto product = [&](int row, int column) {
      double sum = column == 3 ? record.to_object[4 * row + 3] : 0.0;
      for (int k = 0; k < 3; ++k) {
        sum += static_cast<double>(record.to_object[4 * row + k]) * record.to_world[4 * k + column];
      }
      return sum;
    };
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        // Entries of the inverse are up to 1 / 0.05 * 2 = 40, its translations up to 40 * 20.
        EXPECT_NEAR(product(row, column), row == column ? 1.0 : 0.0, column == 3 ? 2e-3 : 1e-4);
      }
    }
  }
}

}  // namespace
}  // namespace dapple
