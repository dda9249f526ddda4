// bake() against closed forms, at vertices and texels: a sphere on a plane, a plane under a disk, a
// closed box inside and out.
#include <gtest/gtest.h>

#include <cmath>

#include "dapple/bake.hpp"
#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Texel (x, y) shows the point that the layout of mesh 0 maps there.
struct TexelPoint {
  V3f point{0, 0, 0};
  bool found = false;
};

TexelPoint point_of_texel(const Mesh& mesh, const BakedTexture& texture, std::size_t mesh_index,
                          std::uint32_t x, std::uint32_t y) {
  const V2f p((static_cast<float>(x) + 0.5f) / static_cast<float>(texture.size),
              (static_cast<float>(y) + 0.5f) / static_cast<float>(texture.size));
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const V2f* uv = &texture.layout.corners[mesh_index][3 * t];
    const V2f a = uv[1] - uv[0], b = uv[2] - uv[0], c = p - uv[0];
    const float area = a.cross(b), v = c.cross(b) / area, w = a.cross(c) / area;
    if (v < 0 || w < 0 || v + w > 1) continue;
    const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * t + k]]; };
    return {corner(0) * (1 - v - w) + corner(1) * v + corner(2) * w, true};
  }
  return {};
}

Scene scene_of(Mesh mesh, bool double_sided = false) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].double_sided = double_sided;
  scene.meshes = {std::move(mesh)};
  scene.instances.resize(1);
  return scene;
}

Mesh plane(float side, std::uint32_t cells) {
  Mesh mesh;
  append_grid(mesh, {-side / 2, 0, -side / 2}, {0, 0, side}, {side, 0, 0}, cells, 0);
  return mesh;
}

/// A sphere of latitude-longitude triangles about (0, height, 0).
Mesh sphere(float radius, float height, std::uint32_t rings) {
  Mesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2 * kPi * j / around;
      mesh.positions.push_back(V3f(static_cast<float>(std::sin(theta) * std::cos(phi)),
                                   static_cast<float>(std::cos(theta)),
                                   static_cast<float>(std::sin(theta) * std::sin(phi))) *
                                   radius +
                               V3f(0, height, 0));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      const std::uint32_t c = a + around, d = b + around;
      if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (i + 1 < rings) mesh.indices.insert(mesh.indices.end(), {b, d, c});
    }
  }
  mesh.materials.resize(mesh.indices.size() / 3);
  return mesh;
}

BakeOptions many_rays(Estimator estimator) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 2048;
  options.estimator = estimator;
  return options;
}

constexpr float kRadius = 1;

/// AO on a plane at distance d from where a sphere of radius 1 touches it: the sphere is wholly
/// above the horizon, so its form factor is (R / D)^2 cos(theta).
double beside_sphere(double d) { return 1 - std::pow(1 / std::sqrt(1 + d * d), 3); }

TEST(BakeClosedForm, APlaneUnderASphereHasItsFormFactorAtVertices) {
  const Scene floor = scene_of(plane(8, 16));
  const Scene ball = scene_of(sphere(kRadius, kRadius, 48));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    BakeOptions options = many_rays(estimator);
    options.at_vertices = true;
    const BakeResult result = bake(floor, options, {}, {ball});
    double largest = 0;
    for (std::size_t v = 0; v < floor.meshes[0].positions.size(); ++v) {
      const V3f& p = floor.meshes[0].positions[v];
      const double d = std::hypot(double{p.x}, double{p.z});
      if (d < 0.4) continue;  // below the sphere facets matter
      largest = std::max(largest, std::fabs(double{result.meshes.at(0).ao[v]} - beside_sphere(d)));
    }
    EXPECT_LT(largest, estimator == Estimator::exact ? 0.01 : 0.03);
  }
}

TEST(BakeClosedForm, APlaneUnderASphereHasItsFormFactorAtTexels) {
  const Scene floor = scene_of(plane(8, 2));
  const Scene ball = scene_of(sphere(kRadius, kRadius, 48));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    BakeOptions options = many_rays(estimator);
    options.vertices = false;
    options.texture = true;
    options.texture_size = 64;
    const BakeResult result = bake(floor, options, {}, {ball});
    ASSERT_EQ(result.texture.ao.size(), 64u * 64u);
    EXPECT_GT(result.texture.coverage, 0.95) << "a square fills the texture";
    double largest = 0;
    int compared = 0;
    for (std::uint32_t y = 1; y < 63; ++y) {
      for (std::uint32_t x = 1; x < 63; ++x) {
        const TexelPoint at = point_of_texel(floor.meshes[0], result.texture, 0, x, y);
        const double d = std::hypot(double{at.point.x}, double{at.point.z});
        if (!at.found || d < 0.6) continue;  // a texel is 0.13 wide
        ++compared;
        largest =
            std::max(largest, std::fabs(double{result.texture.ao[y * 64 + x]} - beside_sphere(d)));
      }
    }
    EXPECT_GT(compared, 3000);
    EXPECT_LT(largest, estimator == Estimator::exact ? 0.015 : 0.03);
  }
}

TEST(BakeClosedForm, ASphereOnALargePlaneSeesTheSkyAsItsNormalSays) {
  // An infinite plane hides (1 - n.y) / 2 of the cosine-weighted hemisphere about n.
  const Scene ball = scene_of(sphere(kRadius, kRadius, 24));
  const Scene floor = scene_of(plane(2000, 1));
  BakeOptions options = many_rays(Estimator::exact);
  options.texture = true;
  options.texture_size = 128;
  const BakeResult result = bake(ball, options, {}, {floor});
  const Mesh& mesh = ball.meshes[0];
  double largest = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double up = double{mesh.positions[v].y} - kRadius;
    largest = std::max(largest, std::fabs(double{result.meshes.at(0).ao[v]} - (1 + up) / 2));
  }
  EXPECT_LT(largest, 0.03) << "triangles are 0.13 wide";
  int compared = 0;
  largest = 0;
  for (std::uint32_t y = 0; y < 128; ++y) {
    for (std::uint32_t x = 0; x < 128; ++x) {
      const TexelPoint at = point_of_texel(mesh, result.texture, 0, x, y);
      if (!at.found) continue;
      ++compared;
      const double up = double{at.point.y} - kRadius;
      largest = std::max(largest, std::fabs(double{result.texture.ao[y * 128 + x]} - (1 + up) / 2));
    }
  }
  EXPECT_GT(compared, 6000);
  EXPECT_LT(largest, 0.06) << "a facet's normal differs by up to 0.07 from its points'";
}

TEST(BakeClosedForm, AClosedBoxIsOpenOutsideAndDarkInside) {
  Scene outside = make_procedural("scene:cube?divisions=4");
  Scene inside = outside;
  for (std::size_t t = 0; t < inside.meshes[0].primitive_count(); ++t)
    std::swap(inside.meshes[0].indices[3 * t], inside.meshes[0].indices[3 * t + 1]);
  for (const bool is_inside : {false, true}) {
    const Scene& box = is_inside ? inside : outside;
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      BakeOptions options = many_rays(estimator);
      options.sides = BakeSides::front;
      options.texture = true;
      options.texture_size = 64;
      const BakeResult result = bake(box, options);
      const float expected = is_inside ? 0.0f : 1.0f;
      // Prefiltered rays that graze a side are partly stopped by it.
      const float tolerance = estimator == Estimator::exact ? 1e-3f : 0.02f;
      for (const float ao : not_empty(result.meshes.at(0).ao)) EXPECT_NEAR(ao, expected, tolerance);
      for (std::uint32_t i = 0; i < 64 * 64; ++i) {
        const TexelPoint at = point_of_texel(box.meshes[0], result.texture, 0, i % 64, i / 64);
        if (at.found) {
          EXPECT_NEAR(result.texture.ao[i], expected, tolerance) << i;
        }
      }
    }
  }
}

// The lower corners of its sides lie in the floor, which takes the lower half of their sky.
TEST(BakeClosedForm, CornersInAFloorHaveTheLimitFromAbove) {
  Mesh box;
  append_grid(box, {-1, 0, 1}, {2, 0, 0}, {0, 2, 0}, 1, 0);
  append_grid(box, {1, 0, -1}, {-2, 0, 0}, {0, 2, 0}, 1, 0);
  append_grid(box, {1, 0, 1}, {0, 0, -2}, {0, 2, 0}, 1, 0);
  append_grid(box, {-1, 0, -1}, {0, 0, 2}, {0, 2, 0}, 1, 0);
  append_grid(box, {-1, 2, 1}, {2, 0, 0}, {0, 0, -2}, 1, 0);
  Scene scene, floor;
  for (Scene* one : {&scene, &floor}) one->materials.resize(1);
  place(scene, box);
  place(floor, square_mesh(2000, 0, 1, 0));
  BakeOptions options;
  options.at_vertices = true;
  options.sides = BakeSides::front;
  options.estimator = Estimator::exact;
  options.rays = 4096;
  options.target_error = 0;
  const BakedMesh baked = bake(scene, options, {}, {floor}).meshes.at(0);
  for (std::size_t v = 0; v < box.positions.size(); ++v) {
    if (box.positions[v].y > 0) continue;
    EXPECT_NEAR(baked.ao[v], 0.5, 0.02) << box.positions[v];
  }
}

TEST(BakeClosedForm, TexelsUnderADiskHaveTheFormFactorOnItsAxis) {
  const Scene disk = make_procedural("scene:disk?radius=2&height=1&opacity=0.85");
  const Scene floor = scene_of(plane(0.02f, 1));
  BakeOptions options = many_rays(Estimator::exact);
  options.vertices = false;
  options.texture = true;
  options.texture_size = 8;
  options.bent = true;
  const BakeResult result = bake(floor, options, {}, {disk});
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_NEAR(result.texture.ao[i], 1 - 0.85 * 0.8, 0.01) << i;
    EXPECT_GT(result.texture.bent[i].y, 0.9f) << i;
  }
}

}  // namespace
}  // namespace dapple
