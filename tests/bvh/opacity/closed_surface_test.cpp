// Closed surfaces: which triangles the builder recognizes as part of one, and that a node's opacity
// does not count their back faces. Also the clumping of coverage maps.
#include "bvh/opacity/closed_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bvh/build/object_bvh.hpp"
#include "bvh/opacity/welded_vertices.hpp"
#include "support/scenes/split_vertices.hpp"
#include "support/scenes/uniform_map.hpp"

namespace dapple {
namespace {

/// Appends a prism from `a` to `b` with `sides` sides and without end faces. Its sides are cut into
/// `parts` rings along its length.
void add_prism(Mesh& mesh, const V3f& a, const V3f& b, float radius, int sides, int parts) {
  const V3f along = (b - a).normalized();
  const V3f x = along.cross(V3f(0.31f, 0.17f, 0.93f)).normalized(), y = along.cross(x);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int ring = 0; ring <= parts; ++ring) {
    const V3f centre = a + (b - a) * (static_cast<float>(ring) / static_cast<float>(parts));
    for (int side = 0; side < sides; ++side) {
      const float angle =
          2 * std::numbers::pi_v<float> * static_cast<float>(side) / static_cast<float>(sides);
      mesh.positions.push_back(centre + (x * std::cos(angle) + y * std::sin(angle)) * radius);
    }
  }
  const auto vertex = [&](int ring, int side) {
    return first + static_cast<std::uint32_t>(ring * sides + side % sides);
  };
  for (int ring = 0; ring < parts; ++ring) {
    for (int side = 0; side < sides; ++side) {
      const std::uint32_t p = vertex(ring, side), q = vertex(ring, side + 1),
                          r = vertex(ring + 1, side), s = vertex(ring + 1, side + 1);
      mesh.indices.insert(mesh.indices.end(), {p, q, r, q, s, r});
      mesh.materials.insert(mesh.materials.end(), 2, 0);
    }
  }
}

void add_card(Mesh& mesh, const V3f& corner, const V3f& u, const V3f& v) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const V3f& p : {corner, corner + u, corner + v, corner + u + v}) mesh.positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 1u, 3u, 2u}) mesh.indices.push_back(first + i);
  mesh.materials.insert(mesh.materials.end(), 2, 0);
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

NodeOpacity opacity_of(const Scene& scene) {
  BuiltObject built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]);
  prefilter(built, TextureIntegrals(scene, built.object.textured));
  return built.object.opacity;
}

std::vector<bool> closed_of(const Mesh& mesh, float opacity = 1.0f) {
  const std::vector<float> opacities(mesh.primitive_count(), opacity);
  const OpaqueTriangles opaque(mesh, opacities);
  return closed_triangles(opaque, welded_vertices(opaque.positions(), opaque.indices()));
}

TEST(ClosedSurface, APrismIsClosedEvenWithOpenEndsACardIsNot) {
  Mesh mesh;
  add_prism(mesh, {0, 0, 0}, {0.3f, 1, 0.2f}, 0.02f, 6, 4);
  const std::size_t prism = mesh.primitive_count();
  add_card(mesh, {1, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0.05f});
  const std::vector<bool> closed = closed_of(mesh);
  ASSERT_EQ(closed.size(), mesh.primitive_count());
  for (std::size_t t = 0; t < closed.size(); ++t) EXPECT_EQ(closed[t], t < prism) << t;
}

TEST(ClosedSurface, SplitVerticesDoNotOpenASurface) {
  Mesh mesh;
  add_prism(mesh, {0, 0, 0}, {0.3f, 1, 0.2f}, 0.02f, 6, 4);
  const std::size_t prism = mesh.primitive_count();
  add_card(mesh, {1, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0.05f});
  // A thousand leaves that touch at one point; eleven of them share an edge, too.
  for (int i = 0; i < 1000; ++i) {
    const float a = 0.7f * static_cast<float>(i), b = 0.31f * static_cast<float>(i * i % 97);
    add_card(mesh, {2, 0, 0}, {std::cos(a), std::sin(a), 0},
             {std::sin(a) * std::sin(b), -std::cos(a) * std::sin(b), std::cos(b)});
  }
  const Mesh split = test::with_split_vertices(mesh);
  const std::vector<bool> closed = closed_of(split);
  ASSERT_EQ(closed.size(), split.primitive_count());
  for (std::size_t t = 0; t < closed.size(); ++t) EXPECT_EQ(closed[t], t < prism) << t;
  const V3f whole = opacity_of(scene_of(mesh)).axes, parts = opacity_of(scene_of(split)).axes;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(parts[axis], whole[axis], 1e-6f) << axis;
}

TEST(ClosedSurface, BothSidesOfASheetAreClosed) {
  Mesh mesh;
  add_card(mesh, {0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0.05f});
  add_card(mesh, {0, 0, 0}, {0, 0.1f, 0.05f}, {0.1f, 0, 0});
  EXPECT_EQ(closed_of(mesh), std::vector<bool>(4, true));
}

TEST(ClosedSurface, TransparentSurfacesAreNotClosed) {
  Mesh mesh;
  add_prism(mesh, {0, 0, 0}, {0, 1, 0}, 0.02f, 6, 4);
  EXPECT_TRUE(closed_of(mesh, 0.9f).empty());
  EXPECT_TRUE(closed_of(mesh, -1.0f).empty());
}

TEST(ClosedSurface, AThinTwigOccludesItsSilhouetteOnce) {
  // The prism is convex, so the projected areas of its sides add up to twice the silhouette's area.
  Mesh mesh;
  add_prism(mesh, {0, 0, 0}, {0.6f, 1, 0.8f}, 0.004f, 6, 12);
  V3f silhouette(0.0f);
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const V3f& a = mesh.positions[mesh.indices[3 * t]];
    const V3f n = (mesh.positions[mesh.indices[3 * t + 1]] - a)
                      .cross(mesh.positions[mesh.indices[3 * t + 2]] - a);
    for (int axis = 0; axis < 3; ++axis) silhouette[axis] += 0.25f * std::fabs(n[axis]);
  }
  Box3f box;
  for (const V3f& p : mesh.positions) box.extendBy(p);
  const V3f twig = opacity_of(scene_of(mesh)).axes;
  for (int axis = 0; axis < 3; ++axis) {
    const float truth = silhouette[axis] / face_area(box, axis);
    // Cells at the rings count some area twice. If front and back faces counted independently, the
    // opacity would be nearly twice the true one.
    EXPECT_NEAR(twig[axis], truth, 0.15f * truth) << axis;
  }
}

TEST(ClosedSurface, TwoCrossedTwigsBothOcclude) {
  // Seen along z the twigs cross, but at different depths: each occludes its own area.
  Mesh one, two;
  add_prism(one, {0, 0, 0}, {1, 1, 0.1f}, 0.004f, 6, 12);
  add_prism(two, {0, 0, 0}, {1, 1, 0.1f}, 0.004f, 6, 12);
  add_prism(two, {0, 1, 0.5f}, {1, 0, 0.6f}, 0.004f, 6, 12);
  const float single = opacity_of(scene_of(one)).axes.z, both = opacity_of(scene_of(two)).axes.z;
  EXPECT_NEAR(both, 2 * single, 0.12f * both);
}

TEST(Clumping, IsZeroForAUniformMapAndOneForAMapOfClearAndFullCells) {
  CoverageMap map = uniform_map({0.3f, 0.5f, 0.9f});
  EXPECT_NEAR(map.statistics().clumping, 0, 1e-5f);
  for (auto& axis : map.transmittance) {
    for (int cell = 0; cell < kMapCells; ++cell) axis[cell] = cell % 3 == 0 ? 0.0f : 1.0f;
  }
  EXPECT_NEAR(map.statistics().clumping, 1, 1e-5f);
  EXPECT_EQ(uniform_map({1, 1, 1}).statistics().clumping, 0) << "a solid is uniform";
}

TEST(Clumping, AClumpOccludesItsProjectedAreaAndItsFactorMatchesDepths) {
  NodeOpacity clump;
  clump.axes = {0.5f, 0.5f, 0.5f};
  const V3f size(1, 1, 1), diagonal = V3f(1, 1, 1).normalized();
  const float uniform = opacity_along(clump, size, diagonal);
  clump.clumping = 1;
  // The projected area is that of an ellipsoid, half of a face; along the diagonal the box has the
  // projected area of sqrt(3) faces.
  EXPECT_NEAR(opacity_along(clump, size, diagonal), 0.5f / std::sqrt(3.0f), 1e-5f);
  EXPECT_GT(uniform, opacity_along(clump, size, diagonal));
  EXPECT_LT(clumping_factor(clump, size), 1.0f);
  EXPECT_NEAR(opacity_along(clump, size, V3f(1, 0, 0)), 0.5f, 1e-5f);
}

}  // namespace
}  // namespace dapple
