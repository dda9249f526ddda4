// Texture layouts: triangles are grouped into charts, charts are packed without overlaps, and each
// texel knows the triangles in it.
#include "bake/texture/texture_layout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "bake/texture/charts.hpp"
#include "bake/texture/packing.hpp"
#include "bake/texture/texel_cover.hpp"
#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

float area_of(const V2f& a, const V2f& b, const V2f& c) { return 0.5f * (b - a).cross(c - a); }

TEST(Charts, ACubeHasSixSquaresAndEachTriangleIsInOne) {
  const Scene scene = make_procedural("scene:cube?divisions=3");
  const Mesh& mesh = scene.meshes.at(0);
  const std::vector<Chart> charts = make_charts(mesh);
  EXPECT_EQ(charts.size(), 6u);
  std::set<std::uint32_t> seen;
  for (const Chart& chart : charts) {
    EXPECT_NEAR(chart.size.x, chart.size.y, 1e-5f * chart.size.x);
    for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
      EXPECT_TRUE(seen.insert(chart.triangles[t]).second);
      const std::uint32_t* corner = &mesh.indices[3 * std::size_t{chart.triangles[t]}];
      const V3f a = mesh.positions[corner[0]], b = mesh.positions[corner[1]],
                c = mesh.positions[corner[2]];
      const float area = 0.5f * (b - a).cross(c - a).length();
      EXPECT_NEAR(area_of(chart.corners[3 * t], chart.corners[3 * t + 1], chart.corners[3 * t + 2]),
                  area, 1e-5f * area)
          << "flat charts keep areas and orientations";
    }
  }
  EXPECT_EQ(seen.size(), mesh.primitive_count());
}

TEST(Charts, AStripThatWindsOverItselfIsDividedIntoItsTriangles) {
  // A helical ramp of two turns, nearly level: seen from above it covers itself.
  Mesh mesh;
  constexpr std::uint32_t kSteps = 64;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double angle = 4 * kPi * i / kSteps;
    for (const double radius : {1.0, 2.0})
      mesh.positions.emplace_back(static_cast<float>(radius * std::cos(angle)),
                                  static_cast<float>(0.01 * i),
                                  static_cast<float>(radius * std::sin(angle)));
    if (i == kSteps) break;
    const std::uint32_t v = 2 * i;
    mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1, v + 1, v + 2, v + 3});
  }
  mesh.materials.resize(mesh.indices.size() / 3);
  EXPECT_EQ(make_charts(mesh).size(), mesh.primitive_count());
}

/// Half a ring of quads in the plane z = 0, of mean radius 1.
Mesh half_ring(float width, std::uint32_t quads) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= quads; ++i) {
    const double angle = kPi * i / quads;
    for (const float r : {1 - width / 2, 1 + width / 2})
      mesh.positions.emplace_back(r * static_cast<float>(std::cos(angle)),
                                  r * static_cast<float>(std::sin(angle)), 0.0f);
  }
  for (std::uint32_t i = 0; i < 2 * quads; i += 2)
    mesh.indices.insert(mesh.indices.end(), {i, i + 1, i + 2, i + 2, i + 1, i + 3});
  mesh.materials.resize(mesh.indices.size() / 3);
  return mesh;
}

TEST(Charts, ABentStripIsDividedAndAStraightOneOnlyIfItIsTooLong) {
  const Mesh ring = half_ring(0.1f, 32);
  std::vector<Chart> whole = make_charts(ring);
  ASSERT_EQ(whole.size(), 1u);
  const auto rect = [](const Chart& chart) { return chart.size.x * chart.size.y; };
  const float before = rect(whole[0]);
  const std::vector<Chart> parts = divide_chart(whole[0], {10, 0.01f});
  ASSERT_GT(parts.size(), 2u);
  float area = 0, rects = 0;
  std::set<std::uint32_t> seen;
  for (const Chart& part : parts) {
    rects += rect(part);
    ASSERT_EQ(part.corners.size(), 3 * part.triangles.size());
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      EXPECT_TRUE(seen.insert(part.triangles[t]).second);
      area +=
          std::fabs(area_of(part.corners[3 * t], part.corners[3 * t + 1], part.corners[3 * t + 2]));
    }
  }
  EXPECT_EQ(seen.size(), ring.primitive_count());
  EXPECT_NEAR(area, kPi * 0.1, 0.002) << "the triangles keep their sizes";
  EXPECT_LT(rects, 0.5f * before);
  Mesh strip;
  append_grid(strip, {0, 0, 0}, {8, 0, 0}, {0, 0, 0.5f}, 8, 0);
  whole = make_charts(strip);
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(divide_chart(whole[0], {10, 0.01f}).size(), 1u);
  for (const Chart& part : divide_chart(whole[0], {3, 10})) EXPECT_LE(part.size.x, 3.01f);
}

TEST(Packing, RectanglesStayApartAndInsideTheTexture) {
  std::vector<V2f> sizes;
  for (int i = 0; i < 200; ++i)
    sizes.emplace_back(1.0f + 0.37f * static_cast<float>(i % 7),
                       0.2f + 0.1f * static_cast<float>(i % 9));
  constexpr std::uint32_t kSize = 128, kGap = 2;
  const Packing packing = pack(sizes, kSize, kGap);
  ASSERT_EQ(packing.rects.size(), sizes.size());
  std::vector<int> owner(kSize * kSize, -1);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const TexelRect& rect = packing.rects[i];
    EXPECT_GE(static_cast<float>(rect.width - 1), sizes[i].x * packing.scale) << i;
    EXPECT_GE(static_cast<float>(rect.height - 1), sizes[i].y * packing.scale) << i;
    ASSERT_LE(rect.x + rect.width, kSize);
    ASSERT_LE(rect.y + rect.height, kSize);
    for (std::uint32_t y = rect.y; y < rect.y + rect.height; ++y) {
      for (std::uint32_t x = rect.x; x < rect.x + rect.width; ++x) {
        EXPECT_EQ(owner[y * kSize + x], -1) << i;
        owner[y * kSize + x] = static_cast<int>(i);
      }
    }
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {  // each with the gap all around
    const TexelRect& rect = packing.rects[i];
    const std::uint32_t right = std::min(kSize, rect.x + rect.width + kGap);
    const std::uint32_t below = std::min(kSize, rect.y + rect.height + kGap);
    for (std::uint32_t y = std::max(rect.y, kGap) - kGap; y < below; ++y) {
      for (std::uint32_t x = std::max(rect.x, kGap) - kGap; x < right; ++x) {
        const int found = owner[y * kSize + x];
        EXPECT_TRUE(found == -1 || found == static_cast<int>(i)) << found << " is close to " << i;
      }
    }
  }
}

TEST(Packing, WhatDoesNotFitSaysSoAndTheSmallestSizeFits) {
  const std::vector<V2f> sizes(1000, V2f(1, 1));
  EXPECT_TRUE(pack(sizes, 64, 2).rects.empty());
  const std::uint32_t size = smallest_size(1000, 2);
  EXPECT_EQ(size, 126u);
  EXPECT_EQ(pack(sizes, size, 2).rects.size(), 1000u);
  EXPECT_TRUE(pack(sizes, size - 1, 2).rects.empty());
  EXPECT_TRUE(pack(std::vector<V2f>(300, V2f(1, 1)), 64, 2).rects.empty())
      << "there is room for 484 points";
}

TEST(TexelCover, PartsOfATriangleAddUpToItsArea) {
  const V2f uv[3] = {{0.11f, 0.07f}, {0.93f, 0.31f}, {0.42f, 0.88f}};
  constexpr std::uint32_t kSize = 16;
  const TexelCover cover = cover_texels(uv, kSize);
  double area = 0;
  for (std::size_t i = 0; i < cover.texel.size(); ++i) {
    EXPECT_EQ(cover.first[i + 1] - cover.first[i], 1u);
    area += double{clip_to_texel(uv, kSize, cover.texel[i] % kSize, cover.texel[i] / kSize).area()};
  }
  EXPECT_NEAR(area, double{area_of(uv[0], uv[1], uv[2])} * kSize * kSize, 1e-3);
}

TEST(TexelCover, TrianglesWithoutAnAreaOrOutsideCoverNothing) {
  const V2f line[3] = {{0.1f, 0.1f}, {0.5f, 0.5f}, {0.9f, 0.9f}};
  const V2f outside[3] = {{1.5f, 0.1f}, {1.9f, 0.1f}, {1.5f, 0.6f}};
  const V2f broken[3] = {{NAN, 0.1f}, {0.9f, 0.1f}, {0.5f, 0.6f}};
  EXPECT_TRUE(cover_texels(line, 16).texel.empty());
  EXPECT_TRUE(cover_texels(outside, 16).texel.empty());
  EXPECT_TRUE(cover_texels(broken, 16).texel.empty());
}

TEST(TextureLayout, TooManyChartsForTheSizeAreAnErrorThatNamesTheSizeThatFits) {
  const Scene scene = make_procedural("scene:cloud?leaves=2000");
  BakeOptions options;
  options.texture_size = 64;
  try {
    make_layout(scene, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    const std::string text = error.what();
    EXPECT_NE(text.find("--size"), std::string::npos);
    EXPECT_NE(text.find("178"), std::string::npos) << text;
  }
  options.texture_size = 256;
  EXPECT_EQ(make_layout(scene, options).charts, 2000u) << "a leaf is a chart";
}

TEST(TextureLayout, OverlapsAreFoundWithTheirShare) {
  Scene scene;
  scene.materials.resize(1);
  scene.instances.resize(1);
  Mesh mesh;
  append_grid(mesh, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 0);  // four vertices, two triangles
  scene.meshes = {mesh};
  const auto uvs_of = [&](float scale) {
    std::vector<V2f> uvs;
    for (const V3f& p : mesh.positions) uvs.emplace_back(scale * p.x, scale * p.z);
    return std::vector<std::vector<V2f>>{uvs};
  };
  EXPECT_EQ(uv_overlap(scene, uvs_of(1), 64), 0);
  EXPECT_TRUE(std::isinf(uv_overlap(scene, uvs_of(1.5f), 64)));
  // A second mesh on half of the first one's texels.
  Scene both = scene;
  both.meshes.push_back(mesh);
  both.instances.push_back({});
  both.instances[1].mesh = 1;
  std::vector<std::vector<V2f>> uvs = uvs_of(1);
  uvs.push_back(uvs_of(1)[0]);
  for (V2f& uv : uvs[1]) uv.x *= 0.5f;
  EXPECT_NEAR(uv_overlap(both, uvs, 64), 0.5, 0.03);
  for (Instance& instance : both.instances) instance.to_world = M44f().setScale(0);
  EXPECT_EQ(uv_overlap(both, uvs, 64), 0) << "nothing is baked";
  EXPECT_NEAR(uv_overlap(both, uvs, 64, BakePlacement::alone), 0.5, 0.03);
}

TEST(TextureLayout, SmallTrianglesOnOneTexelOverlapIfTheyDoNotFitSideBySide) {
  const std::uint32_t size = 64;
  const auto overlap_of = [&](int count, float side) {  // triangles of a palette's colour
    Scene scene;
    scene.materials.resize(1);
    scene.instances.resize(1);
    scene.meshes.resize(1);
    Mesh& mesh = scene.meshes[0];
    std::vector<V2f> uvs;
    for (int i = 0; i < count; ++i) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const V2f& corner : {V2f(0, 0), V2f(side, 0), V2f(0, side)}) {
        mesh.positions.emplace_back(corner.x, static_cast<float>(i), corner.y);
        uvs.push_back((V2f(10.05f, 20.05f) + corner) / static_cast<float>(size));
      }
      mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
      mesh.materials.push_back(0);
    }
    return uv_overlap(scene, {uvs}, size);
  };
  EXPECT_EQ(overlap_of(1000, 0.3f), 1);
  EXPECT_EQ(overlap_of(20, 0.3f), 0) << "0.9 of the texel";
  EXPECT_EQ(overlap_of(24, 0.3f), 1) << "1.08 of it";
}

TEST(TextureLayout, TheShareOfTheSurfaceWithoutTexelsIsThatOfTheWorld) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes.resize(2);
  for (Mesh& mesh : scene.meshes) append_grid(mesh, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 4, 0);
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  scene.instances[1].to_world.scale(V3f(3, 1, 1));  // three quarters of the surface
  const auto share = [&](const auto& uv_of_second) {
    std::vector<std::vector<V2f>> uvs(2);
    for (const V3f& p : scene.meshes[0].positions) {
      uvs[0].emplace_back(p.x, p.z);
      uvs[1].push_back(uv_of_second(p));
    }
    return share_without_texels(scene, uvs, 64, BakePlacement::together);
  };
  EXPECT_EQ(share([](const V3f& p) { return V2f(p.x, p.z); }), 0);
  EXPECT_NEAR(share([](const V3f&) { return V2f(0.3f, 0.7f); }), 0.75, 1e-6) << "a point";
  EXPECT_NEAR(share([](const V3f& p) { return V2f(p.x, 0.1f); }), 0.75, 1e-6) << "a line";
  EXPECT_NEAR(share([](const V3f& p) { return V2f(0.7f * p.x + 0.1f, 0.3f * p.x + 0.2f); }), 0.75,
              1e-6)
      << "a line that rounding makes crooked";
  EXPECT_NEAR(share([](const V3f& p) { return V2f(std::min(p.x, 0.5f), p.z); }), 0.375, 1e-6);
}

TEST(TextureLayout, GivenCoordinatesWithoutAreaAreTold) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes.resize(1);
  append_grid(scene.meshes[0], {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 4, 0);
  scene.instances.resize(1);
  BakeOptions options;
  options.vertices = false;
  options.texture = true;
  options.texture_size = 16;
  options.texture_uvs.resize(1);
  for (const V3f& p : scene.meshes[0].positions)
    options.texture_uvs[0].emplace_back(std::min(p.x, 0.5f), p.z);
  const std::vector<std::string> notes = bake(scene, options).statistics.notes;
  const auto tells = [](const std::string& note) {
    return note == "50.0 % of the surface has no area in the texture, and no values there";
  };
  EXPECT_EQ(std::count_if(notes.begin(), notes.end(), tells), 1);
}

TEST(TextureLayout, GivenCoordinatesThatMissVerticesOrLeaveTheTextureAreRefused) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes.resize(1);
  append_grid(scene.meshes[0], {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 0);
  scene.instances.resize(1);
  const auto message = [&](std::vector<std::vector<V2f>> uvs) -> std::string {
    BakeOptions options;
    options.texture_uvs = std::move(uvs);
    try {
      given_layout(scene, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message({{V2f(0, 0), V2f(0, 1), V2f(1, 0), V2f(1, 1)}}), "no error");
  EXPECT_NE(message({}).find("has 0 for 4 vertices"), std::string::npos);
  EXPECT_NE(message({std::vector(3, V2f(0, 0))}).find("has 3 for 4"), std::string::npos);
  EXPECT_NE(message({std::vector(4, V2f(0.5f, 1.5f))}).find("(0.5, 1.5)"), std::string::npos);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message({std::vector(4, V2f(nan, 0))}).find("(nan, 0)"), std::string::npos);
}

}  // namespace
}  // namespace dapple
