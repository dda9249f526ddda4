// The opaque triangles of a mesh: which they are, their vertices, and flags that go back.
#include "bvh/opacity/opaque_triangles.hpp"

#include <gtest/gtest.h>

#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/wall.hpp"
#include "bvh/opacity/welded_vertices.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

/// A sphere among triangles that are its own but for the vertices: three before each of its
/// triangles.
struct MixedMesh {
  Mesh mesh;
  std::vector<float> opacities;

  MixedMesh() {
    const Mesh sphere = test::smooth_sphere();
    for (const V3f& position : sphere.positions) {
      mesh.positions.push_back(position + V3f(10, 0, 0));
      mesh.positions.push_back(position);
    }
    for (std::size_t t = 0; 3 * t < sphere.indices.size(); ++t) {
      for (int i = 0; i < 4; ++i) {
        const std::uint32_t opaque = i == 3;
        for (int k = 0; k < 3; ++k) mesh.indices.push_back(2 * sphere.indices[3 * t + k] + opaque);
        opacities.push_back(opaque ? 1.0f : i == 0 ? 0.99f : -1.0f);
      }
    }
  }
};

TEST(OpaqueTriangles, HaveTheVerticesOfTheMeshInOrder) {
  const MixedMesh mixed;
  const OpaqueTriangles opaque(mixed.mesh, mixed.opacities);
  ASSERT_EQ(4 * opaque.count(), mixed.opacities.size());
  EXPECT_EQ(2 * opaque.positions().size(), mixed.mesh.positions.size());
  for (std::size_t t = 0; t < opaque.count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t in_mesh = mixed.mesh.indices[3 * (4 * t + 3) + k];
      EXPECT_EQ(opaque.vertex(t, k), in_mesh / 2);
      EXPECT_EQ(opaque.positions()[opaque.vertex(t, k)], mixed.mesh.positions[in_mesh]);
    }
  }
}

TEST(OpaqueTriangles, AreTheMeshItselfIfAllAreOpaque) {
  const Mesh sphere = test::smooth_sphere();
  const std::vector<float> ones(sphere.indices.size() / 3, 1.0f);
  const OpaqueTriangles opaque(sphere, ones);
  EXPECT_EQ(opaque.count(), ones.size());
  EXPECT_EQ(opaque.positions().data(), sphere.positions.data());
}

TEST(OpaqueTriangles, SurfacesAmongOthersAreFound) {
  const MixedMesh mixed;
  const OpaqueTriangles opaque(mixed.mesh, mixed.opacities);
  const std::vector<std::uint32_t> welded = welded_vertices(opaque.positions(), opaque.indices());
  const std::vector<bool> closed = closed_triangles(opaque, welded);
  const std::vector<float> interior = interior_triangles(opaque, welded);
  ASSERT_EQ(closed.size(), mixed.opacities.size());
  ASSERT_EQ(interior.size(), mixed.opacities.size());
  for (std::size_t t = 0; t < closed.size(); ++t) {
    EXPECT_EQ(closed[t], mixed.opacities[t] == 1.0f) << t;
    EXPECT_EQ(interior[t] > 0, mixed.opacities[t] == 1.0f) << t;
  }
}

}  // namespace
}  // namespace dapple
