// HAIR files: the strands, radii, opacities and colours that arrays and their defaults give, which
// segments and strands are dropped and counted in a warning, and which files are refused.
#include "scene/hair_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "dapple/moving_scene.hpp"
#include "support/files/hair_builder.hpp"

namespace dapple::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scene read(const HairBuilder& builder) { return decode_hair(builder.bytes(), "a.hair"); }

std::string refusal(const HairBuilder& builder) {
  return input_error([&] { read(builder); });
}

TEST(HairFile, StrandsOfOneLengthBecomeSegmentsOfOneMesh) {
  const TempFolder folder;
  const std::string path = folder.write("two.hair", two_strands().bytes());
  const Scene scene = load_scene(path);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_TRUE(mesh.has_strands());
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 1, 2, 3, 4, 4, 5}));
  EXPECT_EQ(mesh.positions[4], V3f(1, 1, 0));
  EXPECT_EQ(mesh.primitive_count(), 4u);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.source, path);
  EXPECT_EQ(scene.files, std::vector<std::string>{path});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(HairFile, TheDefaultThicknessIsADiameterAndTheDefaultTransparencyTheMaterials) {
  HairBuilder builder = two_strands();
  builder.default_thickness = 0.25f;
  builder.default_transparency = 0.75f;
  const Scene scene = read(builder);
  EXPECT_EQ(scene.meshes[0].radii, std::vector<float>(6, 0.125f));
  EXPECT_TRUE(scene.meshes[0].vertex_alpha.empty());
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "hair");
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(scene.materials[0].alpha, 0.25f);
}

TEST(HairFile, ArraysReplaceDefaults) {
  HairBuilder builder = two_strands();
  builder.segments = {1, 3};
  builder.default_segments = 77;
  builder.default_thickness = kNan;
  builder.default_transparency = 0.5f;
  builder.thickness = {0.25f, 0.5f, 0.75f, 1, 1.25f, 0};
  builder.transparency = {0, 0.25f, 0.5f, 1, 1.5f, -1};
  builder.colors.assign(18, kNan);
  const Scene scene = read(builder);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 3, 4, 4, 5}));
  ASSERT_EQ(mesh.radii.size(), 6u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(mesh.radii[i], 0.125f * static_cast<float>(i + 1));
  EXPECT_GT(mesh.radii[5], 0.0f);  // the thickness of the tip is 0
  EXPECT_LT(mesh.radii[5], 1e-8f);
  EXPECT_EQ(mesh.vertex_alpha, (std::vector<float>{1, 0.75f, 0.5f, 0, 0, 1}));
  EXPECT_EQ(scene.materials[0].alpha, 1.0f);
  EXPECT_EQ(mesh.colors, std::vector<V3f>(6, V3f(0, 0, 0))) << "not numbers";
  EXPECT_EQ(scene.materials[0].color, V3f(1, 1, 1));
}

TEST(HairFile, TheDefaultColourIsTheMaterialsWhereThereIsNoArray) {
  HairBuilder builder = two_strands();
  builder.default_color = {0.75f, 0.5f, 0.25f};
  const Scene scene = read(builder);
  EXPECT_TRUE(scene.meshes[0].colors.empty());
  EXPECT_EQ(scene.materials.at(0).color, V3f(0.75f, 0.5f, 0.25f));
  builder.default_color = {kNan, -1, 2};
  EXPECT_EQ(read(builder).materials.at(0).color, V3f(0, 0, 1)) << "clamped, not numbers are 0";
}

TEST(HairFile, EachPointHasItsOwnColour) {
  HairBuilder builder = two_strands();
  builder.thickness.assign(6, 0.25f);
  builder.transparency.assign(6, 0.5f);
  builder.colors = {1,    0,    0,     0,      1,     0,      0,    0,        1,  //
                    0.5f, 0.5f, 0.25f, 0.125f, 0.75f, 0.625f, 1.5f, INFINITY, -1};
  const Scene scene = read(builder);
  EXPECT_EQ(scene.meshes[0].colors, (std::vector<V3f>{{1, 0, 0},
                                                      {0, 1, 0},
                                                      {0, 0, 1},
                                                      {0.5f, 0.5f, 0.25f},
                                                      {0.125f, 0.75f, 0.625f},
                                                      {1, 1, 0}}));
  EXPECT_EQ(scene.materials.at(0).color, V3f(1, 1, 1)) << "colours of points replace the default";
}

TEST(HairFile, ColoursStayWithTheirPointsWhereOthersAreDropped) {
  HairBuilder builder;
  builder.strands = 2;
  builder.default_segments = 3;
  builder.points = {1, 0, 0, 1,    0, 0, 1, 0, 0, 1, 0, 0,  // a strand of no length
                    0, 0, 0, kNan, 0, 0, 0, 5, 0, 0, 6, 0};
  for (std::uint32_t i = 0; i < 8; ++i)
    builder.colors.insert(builder.colors.end(), {static_cast<float>(i) / 8, 0, 1});
  const Mesh mesh = read(builder).meshes.at(0);
  EXPECT_EQ(mesh.positions, (std::vector<V3f>{{0, 5, 0}, {0, 6, 0}}));
  EXPECT_EQ(mesh.colors, (std::vector<V3f>{{0.75f, 0, 1}, {0.875f, 0, 1}}));
}

TEST(HairFile, AStrandWithoutSegmentsMayHaveAPointOrNone) {
  HairBuilder builder;
  builder.strands = 3;
  builder.points = {0, 0, 0, 0, 1, 0, 9, 9, 9, 1, 0, 0, 1, 1, 0};
  builder.segments = {1, 0, 1};
  const std::vector<std::uint32_t> two_segments = {0, 1, 2, 3};
  const Scene with_point = read(builder);
  EXPECT_EQ(with_point.meshes[0].indices, two_segments);
  EXPECT_EQ(with_point.meshes[0].positions[2], V3f(1, 0, 0));
  builder.points.erase(builder.points.begin() + 6, builder.points.begin() + 9);
  const Scene without = read(builder);
  EXPECT_EQ(without.meshes[0].indices, two_segments);
  for (const Scene* scene : {&with_point, &without}) {
    ASSERT_EQ(scene->warnings.size(), 1u);
    expect_says(scene->warnings[0], "a.hair: dropped 1 strands that have no segment");
  }
}

TEST(HairFile, SegmentsWithoutLengthAreDroppedWithoutAGap) {
  HairBuilder builder;
  builder.strands = 2;
  builder.default_segments = 3;
  builder.points = {5, 0, 0, 5, 0, 0, 5.0000005f, 0, 0, 5, 1, 0,  //
                    1, 1, 1, 1, 1, 1, 1,          1, 1, 1, 1, 1};
  const Scene scene = read(builder);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.primitive_count(), 1u);
  ASSERT_EQ(mesh.positions.size(), 2u);
  EXPECT_EQ(mesh.positions[0], V3f(5, 0, 0));
  EXPECT_EQ(mesh.positions[1], V3f(5, 1, 0));
  ASSERT_EQ(scene.warnings.size(), 2u);
  expect_says(scene.warnings[0], "dropped 2 segments without length");
  expect_says(scene.warnings[1], "dropped 1 strands that are no longer than thick");
}

TEST(HairFile, ShortSegmentsFarFromTheOriginAreKept) {
  HairBuilder builder;
  builder.strands = 1;
  builder.default_segments = 3;
  constexpr float kFar = 1000;  // a float's step there is 0.00006
  builder.points = {kFar, 0, 0, kFar + 0.001f, 0, 0, kFar + 0.002f, 0, 0, kFar + 0.003f, 0, 0};
  builder.thickness = std::vector<float>(4, 0.0001f);
  EXPECT_EQ(read(builder).meshes[0].primitive_count(), 3u);
}

TEST(HairFile, StrandsNoLongerThanThickAreDroppedWithACount) {
  HairBuilder builder = two_strands();
  builder.thickness = {2, 2, 2, 1.75f, 1.75f, 1.75f};  // both strands have the length 2
  const Scene scene = read(builder);
  EXPECT_EQ(scene.meshes[0].primitive_count(), 2u);
  EXPECT_EQ(scene.meshes[0].positions[0], V3f(1, 0, 0));
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "a.hair: dropped 1 strands that are no longer than thick");
}

TEST(HairFile, APointThatIsNotFiniteCutsItsStrand) {
  HairBuilder builder;
  builder.strands = 1;
  builder.default_segments = 5;
  builder.points = {0, 0, 0, 0, 1, 0, 0, kNan, 0, 0, 3, 0, 0, INFINITY, 0, 0, 5, 0};
  const Scene scene = read(builder);
  EXPECT_EQ(scene.meshes[0].positions, (std::vector<V3f>{{0, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(scene.meshes[0].radii.size(), 2u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "dropped 2 points that are not finite");
}

TEST(HairFile, WhatIsNotAHairFileIsRefused) {
  const auto refusal_of = [](const Bytes& bytes) {
    return input_error([&] { decode_hair(bytes, "a.hair"); });
  };
  Bytes bytes = two_strands().bytes();
  expect_says(refusal_of({}), "a.hair: is not a HAIR file");
  expect_says(refusal_of(Bytes(bytes.begin(), bytes.begin() + 127)), "ends in its header");
  expect_says(refusal_of(Bytes(bytes.begin(), bytes.end() - 1)), "ends early");
  bytes[0] = 'h';
  expect_says(refusal_of(bytes), "is not a HAIR file");
}

TEST(HairFile, CountsThatItsBytesCannotHoldAreRefusedBeforeAnythingIsAllocated) {
  Bytes bytes = two_strands().bytes();
  const auto with = [&](std::size_t at, std::uint32_t value) {
    Bytes edited = bytes;
    for (std::size_t k = 0; k < 4; ++k)
      edited[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
    return input_error([&] { decode_hair(edited, "a.hair"); });
  };
  expect_says(with(4, 0xffffffffu), "its 4,294,967,295 strands of 8,589,934,590 segments take");
  expect_says(with(8, 0xffffffffu), "has 4,294,967,295 points (at most");
  expect_says(with(8, 1u << 28), "need 3,221,225,600 bytes, it has 200");
  expect_says(with(12, 0), "has no array of points");
  expect_says(with(12, 0x102), "does not know (its bits are 0x102)");
  expect_says(with(12, 3), "ends early");
  expect_says(with(16, 3), "has 6 points, but its 2 strands of 6 segments take 8");
  expect_says(with(16, 1), "has 6 points, but its 2 strands of 2 segments take 4");
  expect_says(with(16, 0xffffffffu), "has 6 points, but its 2 strands of 8,589,934,590 segments");
  expect_says(with(4, 0), "has 6 points, but its 0 strands");
}

TEST(HairFile, InvalidThicknessesAndTransparenciesAreRefusedByPoint) {
  HairBuilder builder = two_strands();
  builder.default_thickness = -1;
  expect_says(refusal(builder), "a.hair: its header has a thickness of -1");
  builder.default_thickness = 1;
  builder.default_transparency = kNan;
  expect_says(refusal(builder), "its header has a transparency of nan");
  builder.thickness = {1, 1, 1, 1, kNan, 1};
  builder.transparency = {0, 0, INFINITY, 0, 0, 0};
  expect_says(refusal(builder), "point 2 has a transparency of inf");
  builder.transparency[2] = 0;
  expect_says(refusal(builder), "point 4 has a thickness of nan");
}

TEST(HairFile, AFileWithoutAStrandOfAnyLengthIsRefused) {
  HairBuilder builder = two_strands();
  builder.points.assign(18, 1.0f);
  expect_says(refusal(builder), "has no strand that is longer than thick");
  builder.points = {0, 0, 0, 1, 1, 1};
  builder.default_segments = 0;
  expect_says(refusal(builder), "has no strand that is longer than thick");
}

TEST(HairFile, OnlyRegularFilesAreRead) {
  const TempFolder folder;
  const auto refusal_of = [](const std::string& path) {
    return input_error([&] { load_scene(path); });
  };
  expect_says(refusal_of(folder.path("none.hair")), "none.hair: no such HAIR file");
  const std::string fifo = folder.path("pipe.hair");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  expect_says(refusal_of(fifo), "pipe.hair: is not a regular file");
}

TEST(HairFile, ATimeIsAnsweredByAWarning) {
  const TempFolder folder;
  const std::string path = folder.path("a.hair");
  const auto bytes = two_strands().bytes();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  SceneOptions options;
  EXPECT_TRUE(load_scene(path, options).warnings.empty());
  EXPECT_TRUE(MovingScene(path).at({}).warnings.empty());
  options.time = 2;
  for (const Scene& scene : {load_scene(path, options), MovingScene(path).at(2)}) {
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_says(scene.warnings[0], "a.hair: hair has no animations, and stays");
  }
}

TEST(HairFile, RealHairIsUprightAndLosesOnlyDegenerateStrands) {
  const std::string path = std::string(DAPPLE_SHARED_SCENES) + "/mohawk.hair";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const Scene scene = load_scene(path);
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "dropped 11 strands that are no longer than thick");
  EXPECT_EQ(mesh.primitive_count(), 2217u * 31u);
  EXPECT_NEAR(mesh.radii.at(0), 0.00165363 / 2, 1e-8);
  const Box3f bounds = scene_bounds(scene);
  EXPECT_NEAR(bounds.min.y, 0.21, 0.01);
  EXPECT_NEAR(bounds.max.y, 1.11, 0.01);
}

}  // namespace
}  // namespace dapple::test
