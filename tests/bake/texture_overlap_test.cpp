// How much of a texture triangles share: of one mesh, of several, by a rounding outside of the
// texture, and what a bake reports of given and of its own coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "bake/texture/texture_layout.hpp"
#include "bake/texture/uv_overlap.hpp"
#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr std::uint32_t kSize = 64;

/// Texels whose centre lies on a diagonal of a square count for neither of its triangles.
constexpr double kDiagonals = 0.03;

struct Rect {
  float x, y, width, height;  ///< in the texture
};

/// Meshes and their texture coordinates.
struct Squares {
  Scene scene;
  std::vector<std::vector<V2f>> uvs;

  [[nodiscard]] UvOverlap overlap() const {
    return find_overlap(scene, uvs, kSize, BakePlacement::together);
  }
};

/// Of each mesh a unit square for each of its rectangles.
Squares squares_at(const std::vector<std::vector<Rect>>& rects) {
  Squares squares;
  squares.scene.materials.resize(1);
  squares.uvs.resize(rects.size());
  for (std::size_t m = 0; m < rects.size(); ++m) {
    Mesh mesh;
    for (const Rect& rect : rects[m]) {
      append_grid(mesh,
                  {static_cast<float>(mesh.positions.size()), 3.0f * static_cast<float>(m), 0},
                  {0, 0, 1}, {1, 0, 0}, 1, 0);
      for (const V2f& corner : {V2f(0, 0), V2f(0, 1), V2f(1, 0), V2f(1, 1)})
        squares.uvs[m].emplace_back(rect.x + rect.width * corner.x,
                                    rect.y + rect.height * corner.y);
    }
    place(squares.scene, std::move(mesh));
  }
  return squares;
}

constexpr Rect kFull = {0, 0, 1, 1}, kLeft = {0, 0, 0.5f, 1}, kTop = {0, 0, 1, 0.5f};

void expect_overlap(const UvOverlap& overlap, double share, double within, double among) {
  EXPECT_NEAR(overlap.share, share, share > 0 ? kDiagonals : 0);
  EXPECT_NEAR(overlap.within, within, within > 0 ? kDiagonals : 0);
  EXPECT_NEAR(overlap.among, among, among > 0 ? kDiagonals : 0);
}

TEST(UvOverlap, OfOneMeshAndOfSeveralIsToldApart) {
  expect_overlap(squares_at({{kFull}}).overlap(), 0, 0, 0);
  expect_overlap(squares_at({{kFull, kFull}}).overlap(), 1, 1, 0);
  expect_overlap(squares_at({{kFull}, {kFull}}).overlap(), 1, 0, 1);
  expect_overlap(squares_at({{kFull}, {kLeft, kLeft}}).overlap(), 0.5, 0.5, 0.5);
  expect_overlap(squares_at({{kLeft, kLeft}, {kFull}}).overlap(), 0.5, 0.5, 0.5);
  // Three quarters of the texture are covered, two by the mesh that overlaps itself.
  expect_overlap(squares_at({{kTop}, {kLeft, kLeft}}).overlap(), 2 / 3.0, 2 / 3.0, 1 / 3.0);
}

TEST(UvOverlap, OfSmallTrianglesIsToldApartToo) {
  const auto overlap_of = [](const std::vector<int>& counts) {  // squares on one texel
    constexpr float kSide = 0.7f / kSize;
    std::vector<std::vector<Rect>> rects;
    for (const int count : counts)
      rects.emplace_back(static_cast<std::size_t>(count),
                         Rect{10.2f / kSize, 20.55f / kSize, kSide, 0.4f * kSide});
    return squares_at(rects).overlap();
  };
  // Each has 0.196 of a texel.
  expect_overlap(overlap_of({5}), 0, 0, 0);
  expect_overlap(overlap_of({2, 3}), 0, 0, 0);
  expect_overlap(overlap_of({6}), 1, 1, 0);
  expect_overlap(overlap_of({3, 3}), 1, 0, 1);
  expect_overlap(overlap_of({1, 6}), 1, 1, 1);
}

TEST(UvOverlap, ACoordinateOneRoundingOutsideOfTheTextureIsItsBorder) {
  Squares squares = squares_at({{kFull}});
  const TextureLayout exact = [&] {
    BakeOptions options;
    options.texture_uvs = squares.uvs;
    return given_layout(squares.scene, options);
  }();
  BakeOptions rounded;
  for (const float outside : {1e-7f, 9e-6f}) {
    SCOPED_TRACE(outside);
    const Squares outer = squares_at({{{-outside, -outside, 1 + 2 * outside, 1 + 2 * outside}}});
    ASSERT_LT(outer.uvs[0][0].x, 0);
    ASSERT_GT(outer.uvs[0][3].y, 1);
    EXPECT_EQ(uv_overlap(outer.scene, outer.uvs, kSize), 0);
    EXPECT_EQ(share_without_texels(outer.scene, outer.uvs, kSize, BakePlacement::together), 0);
    rounded.texture_uvs = outer.uvs;
    EXPECT_EQ(given_layout(outer.scene, rounded).corners, exact.corners);
  }
  for (const float wrong : {-2e-5f, 1.00002f, std::nanf("")}) {
    SCOPED_TRACE(wrong);
    squares.uvs[0][1].y = wrong;
    EXPECT_TRUE(std::isinf(uv_overlap(squares.scene, squares.uvs, kSize)));
    rounded.texture_uvs = squares.uvs;
    EXPECT_THROW(given_layout(squares.scene, rounded), Error);
  }
}

TEST(UvOverlap, OfManyLargeTrianglesIsFoundInACoarserTexture) {
  const Squares cards = squares_at({std::vector<Rect>(2000, kLeft), {{0.5f, 0, 0.25f, 1}}});
  const std::clock_t start = std::clock();
  const UvOverlap overlap = find_overlap(cards.scene, cards.uvs, 4096, BakePlacement::together);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  expect_overlap(overlap, 2.0 / 3, 2.0 / 3, 0);
  EXPECT_LT(seconds, 10) << "4,000 triangles of 8 million texels each take a minute";
}

/// What a bake of few rays reports of its texture.
BakedTexture texture_of(const Scene& scene, std::vector<std::vector<V2f>> uvs = {}) {
  BakeOptions options;
  options.vertices = false;
  options.texture = true;
  options.texture_size = kSize;
  options.texture_uvs = std::move(uvs);
  options.target_error = 0;
  options.rays = 8;
  return bake(scene, options).texture;
}

TEST(UvOverlap, OfGivenCoordinatesIsReported) {
  for (const auto& rects : {std::vector<std::vector<Rect>>{{kFull}, {kLeft}},
                            {{kLeft}, {kLeft}},
                            {{kFull}},
                            {{kLeft, kTop}}}) {
    const Squares squares = squares_at(rects);
    const BakedTexture texture = texture_of(squares.scene, squares.uvs);
    EXPECT_EQ(texture.overlap, squares.overlap().share);
  }
}

TEST(UvOverlap, OfAChartThatCoversItselfALittleIsReported) {
  // A ramp of 101 hundredths of a turn, nearly level. Seen from above the last quad is on the
  // first one, a hundredth of what is covered: one chart.
  const auto ramp = [](std::uint32_t steps) {
    Mesh mesh;
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const double angle = 2 * kPi * i / 100;
      for (const double radius : {1.0, 2.0})
        mesh.positions.emplace_back(static_cast<float>(radius * std::cos(angle)),
                                    0.001f * static_cast<float>(i),
                                    static_cast<float>(radius * std::sin(angle)));
      const std::uint32_t v = 2 * i;
      if (i < steps)
        mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1, v + 1, v + 2, v + 3});
    }
    mesh.materials.resize(mesh.indices.size() / 3);
    Scene scene;
    scene.materials.resize(1);
    place(scene, std::move(mesh));
    return scene;
  };
  const BakedTexture over = texture_of(ramp(101)), beside = texture_of(ramp(99));
  EXPECT_EQ(over.layout.charts, 1u);
  EXPECT_NEAR(over.overlap, 0.01, 0.005);
  EXPECT_EQ(beside.layout.charts, 1u);
  EXPECT_EQ(beside.overlap, 0);
}

}  // namespace
}  // namespace dapple
