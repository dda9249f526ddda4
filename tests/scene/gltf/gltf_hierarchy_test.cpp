// The glTF reader's node hierarchy: transforms and scenes, and the cameras and lights of nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

const double kHalfRoot = std::sqrt(0.5);

void expect_near(V3f a, V3f b, float tolerance) {
  EXPECT_LE((a - b).length(), tolerance) << a << " is not " << b;
}

// A few roundings of coordinates up to 10.
constexpr float kRounding = 1e-5f;

TEST(GltfHierarchy, TranslationRotationAndScaleApplyInReverse) {
  GltfBuilder builder;
  const int node = builder.add_triangle();
  builder.doc["nodes"][node]["translation"] = {1, 2, 3};
  // A quarter turn about Y takes +X to -Z.
  builder.doc["nodes"][node]["rotation"] = {0, kHalfRoot, 0, kHalfRoot};
  builder.doc["nodes"][node]["scale"] = {4, 5, 6};
  const Triangle t = world_triangles(builder.load()).at(0);
  expect_near(t[0], V3f(1, 2, 3), kRounding);
  expect_near(t[1], V3f(1, 2, -1), kRounding);
  expect_near(t[2], V3f(1, 7, 3), kRounding);
}

TEST(GltfHierarchy, AMatrixEqualsItsTranslationRotationAndScale) {
  GltfBuilder trs;
  const int first = trs.add_triangle();
  trs.doc["nodes"][first]["translation"] = {1, 2, 3};
  trs.doc["nodes"][first]["rotation"] = {0, kHalfRoot, 0, kHalfRoot};
  trs.doc["nodes"][first]["scale"] = {4, 5, -6};
  GltfBuilder matrix;
  const int second = matrix.add_triangle();
  matrix.doc["nodes"][second]["matrix"] = {0, 0, -4, 0, 0, 5, 0, 0, -6, 0, 0, 0, 1, 2, 3, 1};
  const M44f a = trs.load().instances.at(0).to_world;
  const M44f b = matrix.load().instances.at(0).to_world;
  EXPECT_TRUE(a.equalWithAbsError(b, kRounding)) << a << b;
  EXPECT_LT(a.determinant(), 0.0f) << "a mirrored node stays mirrored";
}

TEST(GltfHierarchy, ChildrenMoveWithTheirParents) {
  GltfBuilder builder;
  const int leaf = builder.add_triangle();
  builder.doc["nodes"][leaf]["translation"] = {1, 0, 0};
  const int twig =
      builder.add("nodes", {{"children", {leaf}}, {"rotation", {0, 0, kHalfRoot, kHalfRoot}}});
  builder.add("nodes", {{"children", {twig}}, {"scale", {2, 2, 2}}});
  // The translation moves (0,0,0) to (1,0,0), the quarter turn about Z moves that to (0,1,0), and
  // the scale doubles its distance.
  expect_near(world_triangles(builder.load()).at(0)[0], V3f(0, 2, 0), kRounding);
}

GltfBuilder two_scenes() {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  builder.doc["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  return builder;
}

TEST(GltfHierarchy, TheDefaultSceneIsShownElseTheFirstElseEveryRoot) {
  GltfBuilder builder = two_scenes();
  ASSERT_EQ(world_triangles(builder.load()).size(), 1u);
  EXPECT_EQ(world_triangles(builder.load())[0][0], V3f(0, 0, 0));
  builder.doc["scene"] = 1;
  ASSERT_EQ(world_triangles(builder.load()).size(), 1u);
  EXPECT_EQ(world_triangles(builder.load())[0][0], V3f(5, 0, 0));
  ASSERT_EQ(builder.load().warnings.size(), 1u);
  EXPECT_TRUE(builder.load().warnings[0].ends_with("of its 2 scenes only scene 1 is read"));
  builder.doc.erase("scene");
  builder.doc.erase("scenes");
  EXPECT_EQ(world_triangles(builder.load()).size(), 2u);
  EXPECT_TRUE(builder.load().warnings.empty());
}

TEST(GltfCamera, KeepsItsPlaceAndLosesTheScaleOfItsNode) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("cameras",
              {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  builder.add("nodes", {{"name", "eye"},
                        {"camera", 0},
                        {"translation", {1, 2, 3}},
                        {"rotation", {0, kHalfRoot, 0, kHalfRoot}},
                        {"scale", {-2, 3, 4}}});
  const Camera camera = builder.load().cameras.at(0);
  EXPECT_EQ(camera.name, "eye");
  EXPECT_EQ(camera.kind, Camera::Kind::perspective);
  EXPECT_FLOAT_EQ(camera.fov_y, 0.5f);
  const M44f expected(0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 2, 3, 1);
  EXPECT_TRUE(camera.to_world.equalWithAbsError(expected, kRounding)) << camera.to_world;
}

TEST(GltfCamera, ThoseOfOneNameGetNumbersAlsoWhereOneIsScaledToNothing) {
  for (const float first : {1.0f, 0.0f}) {
    GltfBuilder builder;
    builder.add_triangle();
    builder.add(
        "cameras",
        {{"name", "eye"}, {"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
    builder.add("nodes", {{"camera", 0}, {"scale", {first, first, first}}});
    builder.add("nodes", {{"camera", 0}, {"translation", {1, 0, 0}}});
    const std::vector<Camera> cameras = builder.load().cameras;
    ASSERT_EQ(cameras.size(), first > 0 ? 2u : 1u);
    EXPECT_EQ(cameras.front().name, first > 0 ? "eye" : "eye_2");
    EXPECT_EQ(cameras.back().name, "eye_2");
    EXPECT_EQ(cameras.back().to_world[3][0], 1);
  }
}

TEST(GltfCamera, ANameThatOneHasIsNotGivenToAnother) {
  GltfBuilder builder;
  builder.add_triangle();
  for (const char* name : {"eye", "eye", "eye_2"}) {
    const int camera = builder.add(
        "cameras",
        {{"name", name}, {"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
    builder.add("nodes", {{"camera", camera}});
  }
  std::vector<std::string> names;
  for (const Camera& camera : builder.load().cameras) names.push_back(camera.name);
  EXPECT_EQ(names, (std::vector<std::string>{"eye", "eye_3", "eye_2"}));
}

TEST(GltfCamera, OrthographicOnesKeepTheirHeight) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("cameras", {{"name", "plan"},
                          {"type", "orthographic"},
                          {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}});
  builder.add("nodes", {{"camera", 0}});
  const Camera camera = builder.load().cameras.at(0);
  EXPECT_EQ(camera.name, "plan");
  EXPECT_EQ(camera.kind, Camera::Kind::orthographic);
  EXPECT_FLOAT_EQ(camera.half_height, 2.0f);
}

Camera camera_with_extras(const json& extras) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("cameras", {{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}},
                          {"extras", extras}});
  builder.add("nodes", {{"camera", 0}});
  return builder.load().cameras.at(0);
}

TEST(GltfCamera, ExtrasBringALens) {
  const Camera lens =
      camera_with_extras({{"dapple_aperture", 0.25}, {"dapple_focus_distance", 3}, {"note", "x"}});
  EXPECT_FLOAT_EQ(lens.lens_radius, 0.25f);
  EXPECT_FLOAT_EQ(lens.focus_distance, 3.0f);
  EXPECT_EQ(camera_with_extras({{"other", 1}}).lens_radius, 0);
  EXPECT_EQ(camera_with_extras("text").lens_radius, 0);
  for (const json& wrong : {json(-1), json("wide"), json(1e30), json::array({1})})
    EXPECT_THROW(camera_with_extras({{"dapple_aperture", wrong}}), Error) << wrong;
  for (const auto& [key, wrong] :
       {std::pair("dapple_aperture", 1.1e6), std::pair("dapple_focus_distance", 0.0),
        std::pair("dapple_focus_distance", 1.1e12)})
    EXPECT_THROW(camera_with_extras({{key, wrong}}), Error) << key << " beyond the option's limit";
}

TEST(GltfCamera, ExtrasOfItsNodeComeFirst) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("cameras", {{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}},
                          {"extras", {{"dapple_aperture", 0.25}, {"dapple_focus_distance", 3}}}});
  builder.add("nodes", {{"extras", {{"dapple_aperture", "not a camera's"}}}});
  builder.add("nodes", {{"name", "shot"}, {"camera", 0}, {"extras", {{"dapple_aperture", 0.5}}}});
  builder.add("nodes", {{"camera", 0}});
  const Scene scene = builder.load();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_FLOAT_EQ(scene.cameras[0].lens_radius, 0.5f);
  EXPECT_FLOAT_EQ(scene.cameras[0].focus_distance, 3.0f);
  EXPECT_FLOAT_EQ(scene.cameras[1].lens_radius, 0.25f);
  EXPECT_TRUE(scene.warnings.empty());
  builder.doc["nodes"].back()["extras"] = {{"dapple_apperture", 0.5}};
  const std::vector<std::string> notes = builder.load().warnings;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("has extras.dapple_apperture, which is ignored: dapple knows "
                          "dapple_aperture and dapple_focus_distance"),
            std::string::npos)
      << notes[0];
}

Scene load_with_light(const json& light, const SceneOptions& options = {}) {
  GltfBuilder builder;
  builder.add_triangle();
  // Not = {light}, which is an array for g++ but a copy of the light for clang 14.
  builder.doc["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
  builder.doc["extensionsRequired"] = {"KHR_lights_punctual"};
  // A quarter turn about X takes -Z to +Y; the scale must change nothing.
  builder.add("nodes", {{"name", "lamp"},
                        {"translation", {0, 4, 0}},
                        {"rotation", {kHalfRoot, 0, 0, kHalfRoot}},
                        {"scale", {3, 3, 3}},
                        {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return builder.load(options);
}

Light load_light(const json& light, const SceneOptions& options = {}) {
  return load_with_light(light, options).lights.at(0);
}

TEST(GltfLight, ADirectionalLightIsASunOfTheSameIrradiance) {
  const Light sun = load_light(
      {{"type", "directional"}, {"name", "noon"}, {"intensity", 3}, {"color", {1, 0.5, 0}}});
  EXPECT_EQ(sun.name, "noon");
  EXPECT_EQ(sun.kind, LightKind::sun);
  expect_near(sun.direction, V3f(0, 1, 0), kRounding);
  const double sine = std::sin(double{sun.angular_radius});
  const double solid = std::numbers::pi * sine * sine;  // projected, of a disk face-on
  EXPECT_NEAR(sun.radiance.x * solid, 3.0, 3e-6);
  EXPECT_NEAR(sun.radiance.y * solid, 1.5, 3e-6);
  EXPECT_EQ(sun.radiance.z, 0.0f);
}

TEST(GltfLight, APointLightIsASphereOfTheSameIntensityWhateverItsNodesScale) {
  SceneOptions options;
  options.light_radius = 0.25f;
  const Light point = load_light({{"type", "point"}, {"intensity", 8}}, options);
  EXPECT_EQ(point.name, "lamp");
  EXPECT_EQ(point.kind, LightKind::sphere);
  EXPECT_EQ(point.radius, 0.25f);
  expect_near(point.position, V3f(0, 4, 0), kRounding);
  EXPECT_NEAR(point.radiance.x * std::numbers::pi * 0.25 * 0.25, 8.0, 8e-6);
  EXPECT_EQ(point.cos_inner, -1.0f);
  EXPECT_EQ(point.cos_outer, -1.0f);
}

// The triangle is 1.4 m across.
TEST(GltfLight, OnlyASphereThatIsLargeForTheSceneHasANote) {
  for (const float radius : {0.1f, 0.2f}) {
    SceneOptions options;
    options.light_radius = radius;
    const std::vector<std::string> notes = load_with_light({{"type", "point"}}, options).warnings;
    ASSERT_EQ(notes.size(), radius > 0.15f ? 1u : 0u);
    if (!notes.empty()) {
      EXPECT_NE(notes[0].find("light \"lamp\" is a sphere of 0.2 m in a scene 1.4 m across"),
                std::string::npos)
          << notes[0];
    }
  }
}

TEST(GltfLight, ASpotIsASphereWithACone) {
  const Light spot =
      load_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}});
  EXPECT_EQ(spot.kind, LightKind::sphere);
  expect_near(spot.direction, V3f(0, 1, 0), kRounding);
  EXPECT_FLOAT_EQ(spot.cos_inner, std::cos(0.25f));
  EXPECT_FLOAT_EQ(spot.cos_outer, std::cos(0.5f));
  try {
    (void)load_light({{"type", "spot"}, {"name", "lamp"}});
    ADD_FAILURE() << "a spot without its cone is taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("light 0 (\"lamp\") is a spot without \"spot\""),
              std::string::npos)
        << error.what();
  }
  const Light standard = load_light({{"type", "spot"}, {"spot", json::object()}});
  EXPECT_FLOAT_EQ(standard.cos_inner, 1.0f);
  EXPECT_FLOAT_EQ(standard.cos_outer, std::cos(std::numbers::pi_v<float> / 4));
  const Light narrow =
      load_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0}, {"outerConeAngle", 1e-4}}}});
  EXPECT_FLOAT_EQ(narrow.cos_outer, std::cos(0.2f * std::numbers::pi_v<float> / 180))
      << "the least";
}

}  // namespace
}  // namespace dapple::test
