// The swaying tree scene:tree?wind=... Without wind, or without a time, it is the tree at rest, bit
// for bit. With wind it has the same triangles, whose positions change smoothly in time and space.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dapple/moving_scene.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

const char* const kWindy = "scene:tree?leaves=3000&wind=1";

Mesh tree_at(const std::string& name, std::optional<double> seconds) {
  return make_procedural(name, seconds).meshes.at(0);
}

float largest_step(const Mesh& a, const Mesh& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i)
    largest = std::max(largest, (a.positions[i] - b.positions[i]).length());
  return largest;
}

TEST(TreeSway, WithoutWindOrTimeTheTreeIsTheSameBitForBit) {
  const Mesh still = tree_at("scene:tree?leaves=3000", {});
  EXPECT_EQ(tree_at("scene:tree?leaves=3000", 1.5).positions, still.positions);
  EXPECT_EQ(tree_at("scene:tree?leaves=3000&wind=0", 1.5).positions, still.positions);
  EXPECT_EQ(tree_at(kWindy, {}).positions, still.positions);
}

TEST(TreeSway, KeepsItsTrianglesAtAllTimes) {
  const Mesh still = tree_at(kWindy, {});
  for (const double seconds : {0.0, 0.7, 1000.0}) {
    const Mesh swayed = tree_at(kWindy, seconds);
    EXPECT_EQ(swayed.indices, still.indices);
    EXPECT_EQ(swayed.materials, still.materials);
    EXPECT_EQ(swayed.positions.size(), still.positions.size());
  }
}

TEST(TreeSway, IsTheSameAtTheSameTime) {
  const MovingScene moving(kWindy);
  EXPECT_EQ(moving.at(2.25).meshes.at(0).positions, tree_at(kWindy, 2.25).positions);
}

// The fastest motion is that of a leaf that nods at up to 1.7 Hz, on a limb that a gust of 1.31 Hz
// moves. Its speed is below 6 m/s.
TEST(TreeSway, IsContinuousInTime) {
  for (const double seconds : {0.0, 3.3, 777.7}) {
    const Mesh now = tree_at(kWindy, seconds);
    const float hundredth = largest_step(now, tree_at(kWindy, seconds + 0.01));
    const float thousandth = largest_step(now, tree_at(kWindy, seconds + 0.001));
    EXPECT_LT(hundredth, 0.06f);
    EXPECT_GT(hundredth, 0.0005f);
    EXPECT_LT(thousandth, 0.2f * hundredth);
  }
}

TEST(TreeSway, MovesTipsByMetresAndTheFootNotAtAll) {
  const Mesh still = tree_at(kWindy, {});
  float top = 0;
  for (const double seconds : {0.0, 1.0, 2.0, 3.0}) {
    const Mesh swayed = tree_at(kWindy, seconds);
    for (std::size_t i = 0; i < still.positions.size(); ++i) {
      const float moved = (swayed.positions[i] - still.positions[i]).length();
      if (still.positions[i].y < 0.01f) {
        EXPECT_EQ(moved, 0);
      }
      if (still.positions[i].y < 1.5f) {
        EXPECT_LT(moved, 0.25f);
      }
      top = std::max(top, moved);
    }
  }
  EXPECT_GT(top, 0.3f);
  EXPECT_LT(top, 3.5f);
}

TEST(TreeSway, KeepsTheSizeOfEveryTriangleOfALeaf) {
  const Mesh still = tree_at("scene:tree?leaves=500&wood=0&wind=2", {});
  const Mesh swayed = tree_at("scene:tree?leaves=500&wood=0&wind=2", 5.0);
  for (std::size_t t = 0; t < still.primitive_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = still.indices[3 * t + k], b = still.indices[3 * t + (k + 1) % 3];
      EXPECT_NEAR((swayed.positions[a] - swayed.positions[b]).length(),
                  (still.positions[a] - still.positions[b]).length(), 1e-5);
    }
  }
}

// Neighbouring vertices move alike: the edges of the wood's triangles hardly change their length.
TEST(TreeSway, DoesNotTearTheWood) {
  const Scene scene = make_procedural("scene:tree?leaves=1&wind=2");
  const Mesh& still = scene.meshes.at(0);
  const Mesh swayed = tree_at("scene:tree?leaves=1&wind=2", 4.0);
  for (std::size_t i = 0; i + 1 < still.indices.size() - 6; ++i) {
    if (i % 3 == 2) continue;
    const std::uint32_t a = still.indices[i], b = still.indices[i + 1];
    const float before = (still.positions[a] - still.positions[b]).length();
    const float after = (swayed.positions[a] - swayed.positions[b]).length();
    EXPECT_NEAR(after, before, 0.25f * before + 0.01f);
  }
}

/// The mean cosine between the normals of corners and their faces.
double agreement(const Mesh& mesh) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const V3f& normal = mesh.normals.at(mesh.indices[i]);
    if (normal.length2() == 0) continue;
    const std::uint32_t* const corner = &mesh.indices[i / 3 * 3];
    const V3f& a = mesh.positions[corner[0]];
    sum += double{(mesh.positions[corner[1]] - a)
                      .cross(mesh.positions[corner[2]] - a)
                      .normalized()
                      .dot(normal)};
    ++count;
  }
  return sum / static_cast<double>(count);
}

TEST(TreeSway, TurnsTheNormalsOfTheWoodWithIt) {
  const Mesh still = tree_at("scene:tree?leaves=1&wind=2", {});
  const Mesh swayed = tree_at("scene:tree?leaves=1&wind=2", 4.0);
  EXPECT_NE(swayed.normals, still.normals);
  EXPECT_GT(agreement(still), 0.85);
  EXPECT_NEAR(agreement(swayed), agreement(still), 0.01);
}

TEST(TreeSway, MoreWindMovesItMore) {
  const Mesh still = tree_at(kWindy, {});
  const float breeze = largest_step(still, tree_at("scene:tree?leaves=3000&wind=0.2", 1.0));
  const float gale = largest_step(still, tree_at("scene:tree?leaves=3000&wind=1", 1.0));
  EXPECT_GT(gale, 2 * breeze);
}

}  // namespace
}  // namespace dapple
