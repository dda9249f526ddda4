// Seams of charts: which there are, and that lookups from both sides agree when they are joined.
#include "bake/texture/seams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "bake/samples/surface_samples.hpp"
#include "bake/texture/texture_layout.hpp"
#include "bake/texture/uv_overlap.hpp"
#include "sampling/random_choice.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// A sphere of two poles whose quads are two triangles each, also where they touch a pole: one of
/// them has no area there, unless `whole` leaves these out.
Mesh sphere(bool whole) {
  constexpr std::uint32_t kRings = 8, kSides = 12;
  Mesh mesh;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring)
    for (std::uint32_t side = 0; side <= kSides; ++side) {
      const double down = kPi * ring / kRings, around = 2 * kPi * (side % kSides) / kSides;
      const double radius = ring % kRings == 0 ? 0 : std::sin(down);
      mesh.positions.emplace_back(radius * std::cos(around), std::cos(down),
                                  radius * std::sin(around));
    }
  for (std::uint32_t ring = 0; ring < kRings; ++ring)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = ring * (kSides + 1) + side, b = a + kSides + 1;
      if (ring > 0 || whole) mesh.indices.insert(mesh.indices.end(), {a, a + 1, b});
      if (ring + 1 < kRings || whole) mesh.indices.insert(mesh.indices.end(), {a + 1, b + 1, b});
    }
  mesh.materials.resize(mesh.indices.size() / 3);
  return mesh;
}

TEST(Seams, TrianglesWithoutAreaChangeNothing) {
  std::size_t charts[2], points[2];
  for (const bool whole : {false, true}) {
    Scene scene;
    scene.meshes = {sphere(whole)};
    scene.materials.resize(1);
    scene.instances.resize(1);
    BakeOptions options;
    options.texture_size = 128;
    const TextureLayout layout = make_layout(scene, options);
    for (const V2f& corner : layout.corners[0]) {
      EXPECT_TRUE(corner.x > 0 && corner.x < 1 && corner.y > 0 && corner.y < 1) << whole;
    }
    EXPECT_EQ(find_overlap(layout.corners, 128).share, 0) << whole;
    charts[whole ? 1 : 0] = layout.charts;
    points[whole ? 1 : 0] = seam_points(scene.meshes[0], layout.corners[0], 128).size();
  }
  EXPECT_EQ(charts[0], charts[1]);
  EXPECT_EQ(points[0], points[1]);
}

TEST(Seams, LookupsFromBothSidesAgreeAndOtherTexelsStay) {
  // A tube of 24 sides: its charts meet along smooth edges.
  Mesh tube;
  constexpr std::uint32_t kSides = 24;
  for (std::uint32_t i = 0; i < 2 * kSides; ++i) {
    const double angle = 2 * kPi * (i / 2) / kSides;
    tube.positions.emplace_back(std::cos(angle), i % 2, std::sin(angle));
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    tube.indices.insert(tube.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
  }
  tube.materials.resize(tube.indices.size() / 3);
  Scene scene;
  scene.meshes = {tube};
  scene.materials.resize(1);
  scene.instances.resize(1);
  BakeOptions options;
  options.texture_size = 128;
  const TextureLayout layout = make_layout(scene, options);
  ASSERT_GT(layout.charts, 1u);
  const std::vector<SeamPoint> points = seam_points(tube, layout.corners[0], 128);
  ASSERT_GE(points.size(), layout.charts);
  std::vector<float> before(128 * 128);
  for (std::uint32_t i = 0; i < before.size(); ++i)
    before[i] = static_cast<float>(hash_of(1, i) % 1000) / 1000;
  std::vector<float> after = before;
  join_seams(points, after);
  const auto step = [&](const std::vector<float>& texels) {
    double sum = 0;
    for (const SeamPoint& p : points) {
      double difference = 0;
      for (std::size_t i = 0; i < 4; ++i)
        difference += double{texels[p.a.texel[i]] * p.a.weight[i]} -
                      double{texels[p.b.texel[i]] * p.b.weight[i]};
      sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(points.size()));
  };
  EXPECT_LT(step(after), 0.05 * step(before));
  std::set<std::uint32_t> read;
  for (const SeamPoint& p : points)
    for (const Lookup* side : {&p.a, &p.b}) read.insert(side->texel.begin(), side->texel.end());
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    if (!read.contains(i)) {
      ASSERT_EQ(after[i], before[i]) << i;
    }
  }
}

TEST(Seams, FlatSheetsAndHardEdgesHaveNone) {
  const Scene cube = make_procedural("scene:cube?divisions=2");
  BakeOptions options;
  options.texture_size = 64;
  const TextureLayout layout = make_layout(cube, options);
  EXPECT_EQ(layout.charts, 6u);
  for (std::size_t m = 0; m < cube.meshes.size(); ++m)
    EXPECT_TRUE(seam_points(cube.meshes[m], layout.corners[m], 64).empty());
}

}  // namespace
}  // namespace dapple
