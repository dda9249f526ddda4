// Keyframe animation of glTF nodes: each kind of interpolation against values computed by hand,
// times outside of the keyframes, which animations play, and which files are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dapple/moving_scene.hpp"
#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

const double kHalfRoot = std::sqrt(0.5);
constexpr float kRounding = 2e-6f;

/// Adds a sampler to an animation, and the animation first if it does not exist. Returns the
/// sampler's index.
int add_sampler(GltfBuilder& b, int times, int values, const char* interpolation,
                std::size_t animation = 0) {
  json& animations = b.doc["animations"];
  if (animations.size() <= animation) {
    animations.push_back({{"samplers", json::array()}, {"channels", json::array()}});
  }
  json& samplers = animations[animation]["samplers"];
  samplers.push_back({{"input", times}, {"output", values}, {"interpolation", interpolation}});
  return static_cast<int>(samplers.size()) - 1;
}

void add_channel(GltfBuilder& b, int sampler, int node, const char* path,
                 std::size_t animation = 0) {
  b.doc["animations"][animation]["channels"].push_back(
      {{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

int add_times(GltfBuilder& b, const std::vector<float>& times) {
  return b.add_accessor(times, kFloat, "SCALAR");
}

/// A triangle whose node has the keyframes `values` at `times`, in seconds.
GltfBuilder moved(const std::vector<float>& times, const std::vector<float>& values,
                  const char* interpolation, const char* path = "translation") {
  GltfBuilder b = one_triangle();
  const bool rotates = std::string(path) == "rotation";
  const int output = b.add_accessor(values, kFloat, rotates ? "VEC4" : "VEC3");
  add_channel(b, add_sampler(b, add_times(b, times), output, interpolation), 0, path);
  return b;
}

SceneOptions at(double seconds, const std::string& animation = "") {
  SceneOptions options;
  options.time = seconds;
  options.animation = animation;
  return options;
}

M44f matrix_at(const GltfBuilder& b, double seconds, const std::string& animation = "") {
  return b.load(at(seconds, animation)).instances.at(0).to_world;
}

V3f position_at(const GltfBuilder& b, double seconds, const std::string& animation = "") {
  const M44f m = matrix_at(b, seconds, animation);
  return {m[3][0], m[3][1], m[3][2]};
}

std::string refusal(const GltfBuilder& b, double seconds = 0.5) {
  return input_error([&] { static_cast<void>(b.load(at(seconds))); });
}

TEST(GltfAnimation, LinearTranslationsAreMeansOfTheirKeyframes) {
  const GltfBuilder b = moved({1, 2, 4}, {0, 0, 0, 4, 8, 0, 4, 8, 6}, "LINEAR");
  EXPECT_EQ(position_at(b, 1.25), V3f(1, 2, 0));
  EXPECT_EQ(position_at(b, 2), V3f(4, 8, 0));
  EXPECT_EQ(position_at(b, 3), V3f(4, 8, 3));
}

TEST(GltfAnimation, TimesBeforeTheFirstKeyframeAndAfterTheLastAreThose) {
  for (const char* interpolation : {"LINEAR", "STEP"}) {
    const GltfBuilder b = moved({1, 2}, {1, 2, 3, 4, 5, 6}, interpolation);
    for (const double early : {-7.0, 0.0, 1.0}) EXPECT_EQ(position_at(b, early), V3f(1, 2, 3));
    for (const double late : {2.0, 2.5, 1e30}) EXPECT_EQ(position_at(b, late), V3f(4, 5, 6));
  }
}

TEST(GltfAnimation, ANoteSaysThatOthersDoNotPlay) {
  GltfBuilder b = moved({0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR");
  EXPECT_TRUE(b.load(at(0.5)).warnings.empty());
  b.doc["animations"].push_back(b.doc["animations"][0]);
  b.doc["animations"][0]["name"] = "sway";
  b.doc["animations"][1]["name"] = "grow";
  ASSERT_EQ(b.load(at(0.5)).warnings.size(), 1u);
  expect_says(b.load(at(0.5)).warnings[0],
              "of its 2 animations only animation 0 (\"sway\") plays; --animation \"*\" plays all");
  for (const char* chosen : {"grow", "*"})
    EXPECT_TRUE(b.load(at(0.5, chosen)).warnings.empty()) << chosen;
  EXPECT_TRUE(b.load().warnings.empty());
}

TEST(GltfAnimation, WithoutATimeNodesStayAsTheyAreWritten) {
  EXPECT_EQ(moved({1, 2}, {1, 2, 3, 4, 5, 6}, "LINEAR").load().instances.at(0).to_world, M44f());
}

TEST(GltfAnimation, StepsHoldAKeyframeUntilTheNext) {
  const GltfBuilder b = moved({0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "STEP");
  EXPECT_EQ(position_at(b, 0.999), V3f(1, 0, 0));
  EXPECT_EQ(position_at(b, 1), V3f(2, 0, 0));
  EXPECT_EQ(position_at(b, 1.999), V3f(2, 0, 0));
}

// Times are floats in files, and n / 24 is a double on the command line.
TEST(GltfAnimation, TheFrameOfAKeyframeShowsIt) {
  std::vector<float> times, values;
  for (int n = 0; n < 24; ++n) {
    times.push_back(static_cast<float>(n) / 24);
    values.insert(values.end(), {static_cast<float>(n), 0, 0});
  }
  for (const char* interpolation : {"STEP", "LINEAR"}) {
    const GltfBuilder b = moved(times, values, interpolation);
    for (int n = 0; n < 24; ++n)
      EXPECT_NEAR(position_at(b, n / 24.0).x, n, 1e-5) << interpolation << " " << n;
  }
}

TEST(GltfAnimation, HiddenCopiesOfAMeshAreNotACrowd) {
  GltfBuilder b = one_triangle();
  b.doc["nodes"] = json::array({{{"scale", {0, 0, 0}}, {"children", json::array()}}});
  for (int i = 1; i <= 1500; ++i) {
    b.doc["nodes"].push_back({{"mesh", 0}, {"translation", {i, 0, 0}}});
    b.doc["nodes"][0]["children"].push_back(i);
  }
  b.doc["scenes"] = {{{"nodes", {0}}}};
  EXPECT_EQ(b.load({}).instances.size(), 1500u);
  b.doc["nodes"][0]["scale"] = {1, 1, 1};
  for (int i = 1; i <= 1500; ++i) b.doc["nodes"][i]["translation"] = {0, 0, 0};
  EXPECT_TRUE(input_error([&] { static_cast<void>(b.load({})); }).find("at one position") !=
              std::string::npos);
}

// Hermite basis at a quarter of the interval: h00 = 27/32, h10 = 9/64, h01 = 5/32, h11 = -3/64.
// Tangents are multiplied by the two seconds between the keyframes.
TEST(GltfAnimation, CubicSplinesPassTheirKeyframesWithTheirTangents) {
  const GltfBuilder b = moved({1, 3},
                              {9, 9, 9, 0, 0, 32, 8, 0, 0,  // in-tangent, value, out-tangent
                               0, 16, 0, 32, 0, 32, 9, 9, 9},
                              "CUBICSPLINE");
  const V3f quarter = position_at(b, 1.5);
  EXPECT_NEAR(quarter.x, 2 * 9.0 / 64 * 8 + 5.0 / 32 * 32, 1e-5);
  EXPECT_NEAR(quarter.y, 2 * -3.0 / 64 * 16, 1e-6);
  EXPECT_NEAR(quarter.z, 32, 1e-5);
  EXPECT_EQ(position_at(b, 1), V3f(0, 0, 32));
  EXPECT_EQ(position_at(b, 3), V3f(32, 0, 32));
}

TEST(GltfAnimation, RotationsTakeTheShorterWayAtASteadyPace) {
  const auto h = static_cast<float>(kHalfRoot);
  // From no rotation to a quarter turn about Z, whose quaternion has either sign.
  for (const float sign : {1.0f, -1.0f}) {
    const GltfBuilder b =
        moved({0, 1}, {0, 0, 0, 1, 0, 0, sign * h, sign * h}, "LINEAR", "rotation");
    for (const double fraction : {0.1, 1.0 / 3, 0.5, 0.8}) {
      const double angle = fraction * M_PI / 2;
      const M44f m = matrix_at(b, fraction);
      EXPECT_NEAR(m[0][0], std::cos(angle), kRounding);
      EXPECT_NEAR(m[0][1], std::sin(angle), kRounding);
      EXPECT_NEAR(m[2][2], 1, kRounding);
    }
  }
}

TEST(GltfAnimation, AlmostEqualRotationsAreInterpolatedTooAndStayUnit) {
  const GltfBuilder b = moved({0, 1}, {0, 0, 0, 1, 0, 0, 1e-6f, 1}, "LINEAR", "rotation");
  const M44f m = matrix_at(b, 0.5);
  EXPECT_NEAR(m[0][1], 1e-6, 1e-8);
  EXPECT_NEAR(m.determinant(), 1, kRounding);
}

// The tangents are zero: the middle of the spline is the mean of both quaternions, made
// unit.
TEST(GltfAnimation, SplinesOfRotationsAreMadeUnit) {
  const auto h = static_cast<float>(kHalfRoot);
  const GltfBuilder b = moved({0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,  //
                                       0, 0, 0, 0, 0, 0, h, h, 0, 0, 0, 0},
                              "CUBICSPLINE", "rotation");
  const M44f m = matrix_at(b, 0.5);
  EXPECT_NEAR(m[0][0], std::cos(M_PI / 4), kRounding);
  EXPECT_NEAR(m[0][1], std::sin(M_PI / 4), kRounding);
}

TEST(GltfAnimation, QuantizedRotationsAreNormalized) {
  GltfBuilder b = one_triangle();
  const int output = b.add_accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170},
                                    kInt16, "VEC4", true);
  add_channel(b, add_sampler(b, add_times(b, {0, 1}), output, "LINEAR"), 0, "rotation");
  EXPECT_NEAR(matrix_at(b, 1)[0][1], 1, 1e-4);
  EXPECT_NEAR(matrix_at(b, 0.5)[0][1], kHalfRoot, 1e-4);
}

TEST(GltfAnimation, PartsOfANodeThatNothingMovesStayAndChildrenFollow) {
  GltfBuilder b = moved({0, 1}, {1, 1, 1, 3, 3, 3}, "LINEAR", "scale");
  b.doc["nodes"][0]["translation"] = {5, 0, 0};
  b.doc["nodes"][0]["children"] = {1};
  b.add("nodes", {{"mesh", 0}, {"translation", {0, 1, 0}}});
  const Scene scene = b.load(at(0.5));
  const M44f parent = scene.instances.at(0).to_world, child = scene.instances.at(1).to_world;
  EXPECT_EQ(parent[0][0], 2.0f);
  EXPECT_EQ(parent[3][0], 5.0f);
  EXPECT_EQ(child[3][1], 2.0f);
  EXPECT_EQ(child[3][0], 5.0f);
}

TEST(GltfAnimation, CamerasAndLightsMoveWithTheirNodes) {
  GltfBuilder b = moved({0, 1}, {0, 0, 0, 8, 0, 0}, "LINEAR");
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.doc["nodes"][0]["camera"] = 0;
  b.doc["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const Scene scene = b.load(at(0.25));
  EXPECT_EQ(scene.cameras.at(0).to_world[3][0], 2.0f);
  EXPECT_EQ(scene.lights.at(0).position, V3f(2, 0, 0));
}

GltfBuilder two_animations() {
  GltfBuilder b = moved({0, 1}, {1, 0, 0, 1, 0, 0}, "STEP");
  b.doc["animations"][0]["name"] = "walk";
  const int output = b.add_positions({0, 7, 0, 0, 7, 0});
  add_channel(b, add_sampler(b, add_times(b, {0, 2.5f}), output, "STEP", 1), 0, "translation", 1);
  const int scale = b.add_positions({2, 2, 2, 2, 2, 2});
  add_channel(b, add_sampler(b, add_times(b, {0, 1}), scale, "STEP", 1), 0, "scale", 1);
  return b;
}

TEST(GltfAnimation, TheFirstPlaysUnlessAnotherOrAllAreChosen) {
  const GltfBuilder b = two_animations();
  EXPECT_EQ(position_at(b, 0), V3f(1, 0, 0));
  EXPECT_EQ(position_at(b, 0, "walk"), V3f(1, 0, 0));
  EXPECT_EQ(matrix_at(b, 0, "walk")[0][0], 1.0f);
  EXPECT_EQ(position_at(b, 0, "animation_1"), V3f(0, 7, 0));
  EXPECT_EQ(matrix_at(b, 0, "*")[0][0], 2.0f);
  EXPECT_EQ(position_at(b, 0, "*"), V3f(0, 7, 0)) << "the last that moves something decides";
}

TEST(GltfAnimation, TheSceneListsAnimationsWithTheirLengths) {
  const Scene scene = two_animations().load();
  ASSERT_EQ(scene.animations.size(), 2u);
  EXPECT_EQ(scene.animations[0].name, "walk");
  EXPECT_EQ(scene.animations[0].seconds, 1.0);
  EXPECT_EQ(scene.animations[1].name, "animation_1");
  EXPECT_EQ(scene.animations[1].seconds, 2.5);
}

TEST(GltfAnimation, ANameThatThereIsNotIsRefusedWithThoseThatThereAre) {
  const auto message = [](const GltfBuilder& b) {
    try {
      static_cast<void>(b.load(at(0, "run")));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return std::string(error.what());
    }
    return std::string();
  };
  expect_says(message(two_animations()), "only these animations: walk, animation_1");
  expect_says(message(one_triangle()), "has no animations");
}

TEST(GltfAnimation, AFileWithoutOneSaysThatItStaysAtRest) {
  const Scene scene = one_triangle().load(at(3));
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "has no animations, and stays in its rest pose");
}

TEST(GltfAnimation, KeyframesThatDoNotIncreaseAreRefusedByChannel) {
  const std::vector<float> values = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& times : {std::vector<float>{0, 1, 1}, {0, 1, 0.5f}, {0, 1, nan}}) {
    expect_says(refusal(moved(times, values, "LINEAR")),
                "animation 0 channel 0: the time of keyframe 2 is");
  }
  GltfBuilder named = moved({1, 0, 2}, values, "LINEAR");
  named.doc["animations"][0]["name"] = "walk";
  expect_says(refusal(named), "animation 0 (\"walk\") channel 0: the time of keyframe 1 is 0");
  // Without a time the reader does not read the keyframes.
  EXPECT_EQ(named.load().instances.size(), 1u);
}

TEST(GltfAnimation, CountsAndTypesThatDoNotMatchAreRefusedByChannelEvenAtRest) {
  expect_says(error_of(moved({0, 1}, {0, 0, 0}, "LINEAR")),
              "animation 0 channel 0 has 2 keyframes of 1 values, but 1 values (accessor 1)");
  expect_says(error_of(moved({0, 1}, {0, 0, 0, 1, 1, 1}, "CUBICSPLINE")),
              "animation 0 channel 0 has 2 keyframes of 3 values, but 2 values");
  GltfBuilder wrong = moved({0, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR");
  wrong.doc["animations"][0]["channels"][0]["target"]["path"] = "rotation";
  expect_says(error_of(wrong),
              "animation 0 channel 0 output is accessor 1, which is VEC3 of float");
  GltfBuilder input = moved({0, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR");
  input.doc["animations"][0]["samplers"][0]["input"] = 1;
  expect_says(error_of(input), "animation 0 channel 0 input is accessor 1, which is VEC3 of float");
  GltfBuilder matrix = moved({0, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR");
  matrix.doc["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  expect_says(error_of(matrix), "animation 0 channel 0 moves node 0, which has a matrix");
}

TEST(GltfAnimation, ValuesThatAreNoneAreRefusedByChannel) {
  const float infinity = std::numeric_limits<float>::infinity();
  expect_says(refusal(moved({0, 1}, {0, 0, 0, 0, infinity, 0}, "LINEAR")),
              "animation 0 channel 0: output 1 (accessor 1) is not finite");
  expect_says(refusal(moved({0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}, "LINEAR", "rotation")),
              "animation 0 channel 0: the rotation at keyframe 0 has length zero");
}

TEST(GltfAnimation, ChannelsOfWhatDappleDoesNotKnowMoveNothing) {
  GltfBuilder b = moved({0, 1}, {1, 0, 0, 1, 0, 0}, "STEP");
  b.doc["animations"][0]["channels"][0]["target"].erase("node");
  EXPECT_EQ(position_at(b, 0), V3f(0, 0, 0));
}

TEST(MovingScene, PosesAFileAtAnyTimeAsLoadingItDoes) {
  const GltfBuilder b = moved({0, 1}, {0, 0, 0, 8, 0, 0}, "LINEAR");
  const TempFolder folder;
  const std::string path = folder.write("scene.glb", b.glb());
  const MovingScene moving(path);
  std::filesystem::remove(path);  // at() must not read the file again
  for (const double seconds : {0.75, 0.25, 0.5})
    EXPECT_EQ(moving.at(seconds).instances.at(0).to_world[3][0], static_cast<float>(8 * seconds));
  const Scene rest = moving.at({});
  EXPECT_EQ(rest.instances.at(0).to_world, M44f());
  EXPECT_EQ(rest.files, std::vector<std::string>{path});
}

}  // namespace
}  // namespace dapple::test
