// Options of dapple bake that change what occludes, against closed forms: a small square on the
// floor that looks up at a large one, one metre above.
#include <gtest/gtest.h>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

// At the border of the large square, 50 metres away, the direction is 89 degrees from the vertical:
// beyond are 0.0004 of the sky. The small one is 1 cm wide.
constexpr float kLarge = 100, kSmall = 0.01f;
// Of 2048 rays. Without strata a standard deviation would be at most 0.5 / sqrt(2048) = 0.011.
constexpr double kTolerance = 0.02;

class BakeOccluders : public BakeCommand {
 protected:
  BakeOccluders() {
    add_square(floor_, {0, 0, 0}, kSmall, "floor");
    write("floor.glb", floor_.glb());
    add_square(roof_, {0, 1, 0}, kLarge, "roof");
    write("roof.glb", roof_.glb());
    GltfBuilder both;
    add_square(both, {0, 0, 0}, kSmall, "floor");
    add_square(both, {0, 1, 0}, kLarge, "roof");
    write("both.glb", both.glb());
  }

  /// A horizontal square around `center` that faces up, with a material of the same name.
  static void add_square(GltfBuilder& builder, const V3f& center, float side,
                         const std::string& name) {
    const float x0 = center.x - side / 2, x1 = x0 + side, z0 = center.z - side / 2, z1 = z0 + side;
    const std::vector<float> corners = {x0, center.y, z0, x0, center.y, z1,
                                        x1, center.y, z1, x1, center.y, z0};
    const int node = builder.add_mesh(
        {{"attributes", {{"POSITION", builder.add_positions(corners)}}},
         {"indices", builder.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3},
                                          test::kUint16, "SCALAR")},
         {"material", builder.add("materials", {{"name", name}})}});
    builder.doc["scenes"][0]["nodes"].push_back(node);
  }

  /// AO at the vertices of the first mesh of a file.
  [[nodiscard]] std::vector<float> bake(const std::string& arguments) const {
    const Outcome run =
        dapple("bake " + arguments + " -o out.glb --channel _AO --rays 2048 --estimator exact");
    EXPECT_EQ(run.code, 0) << run.err;
    const test::GltfData file(path("out.glb"));
    return file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["_AO"]);
  }
  void expect_ao(const std::string& arguments, double expected) const {
    for (const float ao : bake(arguments)) EXPECT_NEAR(ao, expected, kTolerance) << arguments;
  }

  GltfBuilder floor_, roof_;
};

TEST_F(BakeOccluders, OfAnOpacityLetTheRestThrough) {
  expect_ao("both.glb", 0);
  expect_ao("both.glb --opacity roof=0.3", 0.7);
  expect_ao("both.glb --opacity floor=0.3", 0);
  expect_ao("floor.glb --occluders roof.glb --opacity roof=0.3", 0.7);
}

// A plane at height h takes 1 - (h/D)^2 of the sky from a point that sees no farther than D. With
// weights of (1 - t/D) it takes the integral of 2 u (1 - h / (D u)) over the cosine u from h/D to
// 1, (1 - h/D)^2.
TEST_F(BakeOccluders, BeyondTheDistanceDoNotCountAndWithAFalloffThoseNearItCountLess) {
  expect_ao("both.glb --ao-distance 0.9", 1);
  expect_ao("both.glb --ao-distance 2", 0.25);
  expect_ao("both.glb --ao-distance 2 --ao-falloff 1", 0.75);
}

TEST_F(BakeOccluders, OfOtherFilesDarkenTheFileThatIsBakedAndAreNotInIt) {
  expect_ao("floor.glb", 1);
  expect_ao("floor.glb --occluders roof.glb", 0);
  json after = document("out.glb"), before = document("floor.glb");
  after["meshes"][0]["primitives"][0]["attributes"].erase("_AO");
  for (const char* key : {"nodes", "meshes", "materials", "scenes"})
    EXPECT_EQ(after[key], before[key]) << key;
}

TEST_F(BakeOccluders, OfOtherFilesDarkenWhatIsNearThem) {
  GltfBuilder strip;
  const std::vector<float> corners = {0, 0, 0, 0, 0, 0.01f, 20, 0, 0};
  strip.add_mesh({{"attributes", {{"POSITION", strip.add_positions(corners)}}}});
  write("strip.glb", strip.glb());
  const auto write_canopy = [&](const std::string& name, float x) {
    GltfBuilder canopy;
    add_square(canopy, {x, 0.5f, 0}, 8, "canopy");
    write(name, canopy.glb());
  };
  write_canopy("first.glb", 0);
  write_canopy("last.glb", 20);
  const std::vector<float> one = bake("strip.glb --at vertices --occluders first.glb");
  EXPECT_LT(one[0], 0.05f);
  EXPECT_GT(one[2], 0.99f);
  const std::vector<float> two =
      bake("strip.glb --at vertices --occluders first.glb --occluders last.glb");
  EXPECT_LT(two[0], 0.05f);
  EXPECT_LT(two[2], 0.05f);
}

// The lower half of the sky before a wall is ground, which has half of its cosines. The ground is
// 200 times as wide as the wall, and the wall a hundredth as high as wide.
TEST_F(BakeOccluders, TheGroundTakesTheLowerHalfOfTheSkyFromAWall) {
  GltfBuilder wall;
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 0.01f, 0};
  wall.add_mesh({{"attributes", {{"POSITION", wall.add_positions(corners)}}}});
  write("wall.glb", wall.glb());
  expect_ao("wall.glb", 1);
  expect_ao("wall.glb --ground", 0.5);
  EXPECT_EQ(document("out.glb")["meshes"].size(), 1u);
}

TEST_F(BakeOccluders, VerticesThatSeeNothingKeepTheirNormals) {
  GltfBuilder floor;
  const std::vector<float> corners = {0, 0, 0, 0, 0, 0.01f, 0.01f, 0, 0};
  const std::vector<float> normals = {0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0};
  floor.add_mesh({{"attributes",
                   {{"POSITION", floor.add_positions(corners)},
                    {"NORMAL", floor.add_accessor(normals, test::kFloat, "VEC3")}}}});
  write("hidden.glb", floor.glb());
  GltfBuilder near;
  add_square(near, {0, 0.001f, 0}, kLarge, "near");
  write("near.glb", near.glb());
  const std::string options =
      "bake hidden.glb --occluders near.glb --sides front --estimator exact --rays 256 "
      "--passes ao,bent --bent-channel NORMAL -o out.glb";
  const Outcome run = dapple(options);
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData file(path("out.glb"));
  const std::vector<float> found =
      file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]);
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_NEAR(found[i], normals[i], 1e-4f) << i;
}

TEST_F(BakeOccluders, SeveralFilesMayFollowOneOptionAndASceneAmongThemIsMissed) {
  expect_ao("floor.glb --occluders floor.glb roof.glb", 0);
  expect_ao("--occluders floor.glb roof.glb -- floor.glb", 0);
  const Outcome run = dapple("bake --occluders roof.glb floor.glb -o none.glb");
  expect_failure(run, 2,
                 "SCENE is missing: --occluders takes all files that follow it; write SCENE before "
                 "--occluders, or after --, as in --occluders FILE... -- SCENE");
  expect_failure(dapple("bake floor.glb --occluders roof.glb"), 2, "dapple: --output is missing;");
  expect_failure(dapple("bake -o none.glb"), 2, "dapple: SCENE is missing;");
}

// As in a render: the plane that --ground adds is no material of the file.
TEST_F(BakeOccluders, TheAddedGroundIsNoMaterialThatAnOpacityCanBeFor) {
  expect_failure(dapple("bake floor.glb --ground --opacity ground=0 -o none.glb"), 2,
                 "floor.glb: there is no material \"ground\"; there are: \"floor\"");
}

TEST_F(BakeOccluders, NotesOfTheirFilesAreSaid) {
  test::json points = roof_.doc["meshes"][0]["primitives"][0];
  points["mode"] = 0;
  roof_.doc["meshes"][0]["primitives"].push_back(points);
  write("noted.glb", roof_.glb());
  const Outcome run = dapple("bake floor.glb --occluders noted.glb --rays 16 -o out.glb");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "point primitives are ignored")) << run.err;
}

TEST_F(BakeOccluders, ThatEmitLightAreSaidNotTo) {
  roof_.doc["materials"][0]["emissiveFactor"] = {1, 1, 1};
  write("lamp.glb", roof_.glb());
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "direction": [0, -1, 0],
      "irradiance": 1}]})";
  const std::string bake = "bake floor.glb --occluders lamp.glb --rays 16 -o out.glb ";
  const Outcome lit = dapple(bake + "--passes ao,light --lights sun.json");
  EXPECT_EQ(lit.code, 0) << lit.err;
  EXPECT_TRUE(contains(lit.err, "lamp.glb: its 1 light is not baked")) << lit.err;
  EXPECT_FALSE(contains(dapple(bake).err, "is not baked"));
}

}  // namespace
}  // namespace dapple
