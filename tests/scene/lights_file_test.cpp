// Lights files. Each kind of light has the position, the axes and the radiance that its keys say; a
// wrong file is refused with a message that names the file, the light and the key.
#include <sys/stat.h>

#include <cmath>
#include <numbers>

#include "support/files/lights_text.hpp"

namespace dapple {
namespace {

using namespace lights_test;

constexpr const char* kSphere = R"("type": "sphere", "position": [1, 2, 3], "radiance": 2)";

TEST(LightsFile, ARectsAxesFollowFromItsNormal) {
  const Light light = load_one(R"("name": "key", "type": "rect", "position": [1, 2, 3],
      "normal": [0, 0, -2], "size": [4, 6], "radiance": [1, 2, 3])")
                          .at(0);
  EXPECT_EQ(light.kind, LightKind::rect);
  EXPECT_EQ(light.name, "key");
  EXPECT_EQ(light.position, V3f(1, 2, 3));
  EXPECT_EQ(light.direction, V3f(0, 0, -1));
  // cross((0,0,-1), +Y) = (1,0,0); cross((0,0,-1), (1,0,0)) = (0,-1,0).
  EXPECT_EQ(light.edge_u, V3f(4, 0, 0));
  EXPECT_EQ(light.edge_v, V3f(0, -6, 0));
  EXPECT_EQ(light.radiance, V3f(1, 2, 3));
}

TEST(LightsFile, ARectThatFacesStraightDownOrUpHasXForItsFirstAxis) {
  for (const int y : {-1, 1}) {
    const Light light = load_one("\"type\": \"rect\", \"position\": [0, 5, 0], \"normal\": [0, " +
                                 std::to_string(y) + ", 0], \"size\": [2, 3], \"radiance\": 1")
                            .at(0);
    EXPECT_EQ(light.edge_u, V3f(2, 0, 0));
    EXPECT_EQ(light.edge_v, V3f(0, 0, static_cast<float>(-3 * y)));  // cross((0,y,0), +X)
  }
}

TEST(LightsFile, ASlantedRectsEdgesAreAcrossItsNormalAndAsLongAsItsSize) {
  const Light light = load_one(R"("type": "rect", "position": [0, 0, 0], "normal": [1, -2, 0.5],
      "size": [0.3, 7], "radiance": 1)")
                          .at(0);
  EXPECT_NEAR(light.direction.length(), 1, 1e-6);
  EXPECT_NEAR(light.edge_u.length(), 0.3, 1e-6);
  EXPECT_NEAR(light.edge_v.length(), 7, 1e-5);
  EXPECT_NEAR(light.edge_u.dot(light.direction), 0, 1e-6);
  EXPECT_NEAR(light.edge_v.dot(light.direction), 0, 1e-5);
  EXPECT_NEAR(light.edge_u.y, 0, 1e-7);  // the first axis is level
}

TEST(LightsFile, ASphereHasItsRadiusAndAGreyNumberForRadiance) {
  const Light light = load_one(std::string(kSphere) + ", \"radius\": 0.5").at(0);
  EXPECT_EQ(light.kind, LightKind::sphere);
  EXPECT_EQ(light.position, V3f(1, 2, 3));
  EXPECT_EQ(light.radius, 0.5f);
  EXPECT_EQ(light.radiance, V3f(2, 2, 2));
}

TEST(LightsFile, ADiskHasItsRadiusAndFacesItsNormalOrTarget) {
  const std::string disk = R"("type": "disk", "position": [1, 2, 3], "radius": 0.5,
      "radiance": [1, 2, 3], )";
  const Light facing = load_one(disk + R"("normal": [0, 0, -2])").at(0);
  EXPECT_EQ(facing.kind, LightKind::disk);
  EXPECT_EQ(facing.position, V3f(1, 2, 3));
  EXPECT_EQ(facing.radius, 0.5f);
  EXPECT_EQ(facing.direction, V3f(0, 0, -1));
  EXPECT_EQ(facing.radiance, V3f(1, 2, 3));
  EXPECT_EQ(load_one(disk + R"("target": [1, 2, -7])").at(0).direction, V3f(0, 0, -1));
}

TEST(LightsFile, ASpotIsASphereWithTheConeOfKhrLightsPunctual) {
  const std::string spot = R"("type": "spot", "position": [0, 3, 0], "target": [4, 0, 0],
      "radius": 0.1, "radiance": 5)";
  const Light given = load_one(spot + R"(, "inner_degrees": 30, "outer_degrees": 60)").at(0);
  EXPECT_EQ(given.kind, LightKind::sphere);
  EXPECT_TRUE(given.direction.equalWithAbsError(V3f(0.8f, -0.6f, 0), 1e-6f));
  EXPECT_NEAR(given.cos_inner, std::sqrt(0.75), 1e-6);
  EXPECT_NEAR(given.cos_outer, 0.5, 1e-6);
  const Light by_default = load_one(spot).at(0);
  EXPECT_EQ(by_default.cos_inner, 1);
  EXPECT_NEAR(by_default.cos_outer, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(load_one(spot + R"(, "outer_degrees": 90)").at(0).cos_outer, 0, 1e-7);
  EXPECT_EQ(complaint_about(spot + R"(, "inner_degrees": 50)"),
            "light 1: inner_degrees must be from 0 to 45, and is 50");
  EXPECT_EQ(complaint_about(spot + R"(, "outer_degrees": 0.1)"),
            "light 1: outer_degrees must be from 0.2 to 90, and is 0.1");
}

TEST(LightsFile, ATargetTakesThePlaceOfANormal) {
  const std::string rect = R"("type": "rect", "position": [1, 5, 1], "size": [1, 1],
      "radiance": 1)";
  EXPECT_EQ(load_one(rect + R"(, "target": [1, -3, 1])").at(0).direction, V3f(0, -1, 0));
  EXPECT_EQ(complaint_about(rect), "light 1: normal or target is missing: where the light shines");
  EXPECT_EQ(complaint_about(rect + R"(, "normal": [0, -1, 0], "target": [0, 0, 0])"),
            "light 1: normal and target are given: leave one out");
  EXPECT_EQ(complaint_about(rect + R"(, "target": [1, 5, 1])"),
            "light 1: target is the light's position: no direction leads there");
}

TEST(LightsFile, ADomesRotationIsInDegreesOfWhichWholeTurnsDoNotCount) {
  const auto rotation = [](const std::string& degrees) {
    return load_one(R"("type": "dome", "rotation_degrees": )" + degrees).at(0).rotation;
  };
  const auto quarter = std::numbers::pi_v<float> / 2;
  EXPECT_FLOAT_EQ(rotation("90"), quarter);
  EXPECT_FLOAT_EQ(rotation("-90"), -quarter);
  EXPECT_FLOAT_EQ(rotation("450"), quarter);
  EXPECT_FLOAT_EQ(rotation("270"), -quarter);
  EXPECT_EQ(rotation("-720"), 0);
  EXPECT_EQ(load_one(R"("type": "dome")").at(0).rotation, 0);
}

TEST(LightsFile, ExposureIsInStops) {
  const auto exposed = [](const std::string& stops) {
    return load_one(std::string(kSphere) + ", \"radius\": 1, \"exposure\": " + stops)
        .at(0)
        .radiance;
  };
  EXPECT_EQ(exposed("3"), V3f(16, 16, 16));
  EXPECT_EQ(exposed("-1"), V3f(1, 1, 1));
  EXPECT_NEAR(exposed("0.5").x, 2 * std::sqrt(2.0), 1e-6);
  EXPECT_EQ(complaint_about(R"("type": "dome", "exposure": 101)"),
            "light 1: exposure must be from -100 to 100, and is 101");
  EXPECT_EQ(complaint_about(R"("type": "dome", "exposure": 100)"),
            "light 1: exposure makes a radiance above 1e+30");
}

TEST(LightsFile, ALightThatIsNotEnabledIsCheckedAndLeftOut) {
  const std::string on = R"({"type": "dome"})", off = R"({"type": "dome", "enabled": false})";
  const auto lights = load("{\"lights\": [" + off + "," + on + "]}");
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].name, "dome_2") << "numbers count all lights of the file";
  EXPECT_EQ(lights[0].sequence, 1) << "and so does its noise";
  EXPECT_EQ(load_one(R"("type": "dome", "enabled": true)").size(), 1u);
  EXPECT_EQ(complaint_about(R"("type": "dome", "enabled": false, "radiance": -1)"),
            "light 1: radiance must not be negative, and is -1");
}

TEST(LightsFile, LightsMayHaveAGroup) {
  EXPECT_EQ(load_one(R"("type": "dome", "group": "fill")").at(0).group, "fill");
  EXPECT_EQ(load_one(R"("type": "dome")").at(0).group, "");
  EXPECT_EQ(complaint_about(R"("type": "dome", "group": "")"), "light 1: group must not be empty");
}

TEST(LightsFile, ASunsIrradianceIsThatOfItsDisk) {
  const Light light = load_one(R"("type": "sun", "direction": [0, -3, 0], "angle_degrees": 60,
      "irradiance": [1, 2, 0])")
                          .at(0);
  EXPECT_EQ(light.kind, LightKind::sun);
  EXPECT_EQ(light.direction, V3f(0, -1, 0));
  EXPECT_NEAR(light.angular_radius, std::numbers::pi / 6, 1e-6);  // half of the angular diameter
  // E = pi sin^2(30 degrees) L = pi / 4 L.
  EXPECT_NEAR(light.radiance.x, 4 / std::numbers::pi, 1e-5);
  EXPECT_NEAR(light.radiance.y, 8 / std::numbers::pi, 1e-5);
  EXPECT_EQ(light.radiance.z, 0);
}

TEST(LightsFile, ASunMayBeAsBrightAsAnyLight) {
  const std::string sun = R"("type": "sun", "direction": [0, -1, 0], "irradiance": )";
  EXPECT_NEAR(load_one(sun + "1e25").at(0).radiance.x / 1.47e29, 1, 0.01);
  EXPECT_EQ(complaint_about(sun + "1e26"),
            "light 1: irradiance is too large for so small an angle_degrees");
}

TEST(LightsFile, ASunWithoutAnAngleIsAsLargeAsOurs) {
  const Light light = load_one(R"("type": "sun", "direction": [0, -1, 0], "radiance": 7)").at(0);
  EXPECT_NEAR(light.angular_radius, 0.2665 * std::numbers::pi / 180, 1e-7);
  EXPECT_EQ(light.radiance, V3f(7, 7, 7));
}

TEST(LightsFile, ALightWithoutANameIsCalledByItsTypeAndNumber) {
  const std::string sphere = std::string("{").append(kSphere).append(", \"radius\": 1}");
  const auto lights = load("{\"lights\": [" + sphere + "," + sphere + R"(,
      {"type": "sun", "direction": [0, -1, 0], "radiance": 1}]})");
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].name, "sphere_1");
  EXPECT_EQ(lights[1].name, "sphere_2");
  EXPECT_EQ(lights[2].name, "sun_3");
}

TEST(LightsFile, AnEmptyListIsNoLights) { EXPECT_TRUE(load("{\"lights\": []}").empty()); }

TEST(LightsFile, AnUnknownKeyIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(complaint_about(std::string(kSphere) + ", \"name\": \"a\", \"raduis\": 1"),
            "light 1 (\"a\"): \"raduis\" is not known here; known: name, type, group, enabled, "
            "exposure, position, radius, radiance");
  EXPECT_EQ(complaint("{\"lights\": [], \"light\": 1}"),
            "\"light\" is not known here; known: lights");
}

TEST(LightsFile, AMissingOrMistypedKeyIsNamed) {
  EXPECT_EQ(complaint_about(kSphere), "light 1: radius is missing");
  EXPECT_EQ(complaint_about("\"name\": \"a\""), "light 1 (\"a\"): type is missing");
  EXPECT_EQ(complaint_about(R"("type": "moon")"),
            "light 1: type \"moon\" is not rect, disk, sphere, spot, sun or dome");
  EXPECT_EQ(complaint_about(R"("type": "sun", "direction": [0, 1], "radiance": 1)"),
            "light 1: direction must be an array of 3 numbers");
  EXPECT_EQ(complaint_about(R"("type": "sun", "direction": [0, 1, "x"], "radiance": 1)"),
            "light 1: direction[2] must be a number");
  EXPECT_EQ(complaint_about(R"("type": "sun", "direction": [0, 0, 0], "radiance": 1)"),
            "light 1: direction has no direction: it is 0, 0, 0");
  EXPECT_EQ(complaint_about(R"("type": "sun", "name": 3, "direction": [0, 1, 0], "radiance": 1)"),
            "light 1: name must be a string");
  EXPECT_EQ(complaint_about(R"("type": "sun", "direction": [0, 1, 0], "radiance": true)"),
            "light 1: radiance must be a number or an array of 3 numbers");
  EXPECT_EQ(complaint("{\"lights\": [3]}"), "light 1: is not an object");
}

TEST(LightsFile, ASizeThatIsNotPositiveOrRadianceBelowZeroIsRefused) {
  const std::string rect = R"("type": "rect", "position": [0, 0, 0], "normal": [0, -1, 0], )";
  EXPECT_EQ(complaint_about(rect + R"("size": [1, -2], "radiance": 1)"),
            "light 1: size[1] must be positive, and is -2");
  EXPECT_EQ(complaint_about(std::string(kSphere) + ", \"radius\": 0"),
            "light 1: radius must be positive, and is 0");
  EXPECT_EQ(complaint_about(rect + R"("size": [1, 2], "radiance": [1, -1, 0])"),
            "light 1: radiance must not be negative, and is -1");
  EXPECT_EQ(complaint_about(std::string(kSphere) + ", \"radius\": 1e300"),
            "light 1: radius is too large");
  EXPECT_EQ(complaint_about(
                R"("type": "sun", "direction": [0, 1, 0], "radiance": 1, "angle_degrees": 180)"),
            "light 1: angle_degrees must be from 0.0001 to 179.999, and is 180");
}

TEST(LightsFile, NumbersThatFloatCannotRenderAreRefused) {
  const std::string rect = R"("type": "rect", "position": [0, 0, 0], "normal": [0, -1, 0], )";
  EXPECT_EQ(complaint_about(std::string(kSphere) + ", \"radius\": 1e30"),
            "light 1: radius must be from 1e-09 to 1e+12 m, and is 1e+30");
  EXPECT_EQ(complaint_about(rect + R"("size": [1e-30, 1], "radiance": 1)"),
            "light 1: size[0] must be from 1e-09 to 1e+12 m, and is 1e-30");
  EXPECT_EQ(complaint_about(rect + R"("size": [1, 1], "radiance": 1e38)"),
            "light 1: radiance is above 1e+30");
  EXPECT_EQ(complaint_about(
                R"("type": "rect", "position": [0, 1e20, 0], "normal": [0, -1, 0],
                   "size": [1, 1], "radiance": 1)"),
            "light 1: position[1] must be within 1e+12 m");
}

TEST(LightsFile, AKeyTwiceAndLightsByTheMillionAreRefusedAtOnce) {
  EXPECT_EQ(complaint(R"({"lights": [{"type": "sun", "type": "rect"}]})"),
            "has the key \"type\" twice in one object");
  std::string many = "{\"lights\": [";
  for (int i = 0; i < 3'000'000; ++i) many += "{},";
  EXPECT_EQ(complaint(many + "{}]}"), "has 3000001 lights; there may be 4096");
}

TEST(LightsFile, ASunHasEitherRadianceOrIrradiance) {
  EXPECT_EQ(complaint_about(R"("type": "sun", "direction": [0, 1, 0])"),
            "light 1: radiance or irradiance is missing: how bright the sun is");
  EXPECT_EQ(
      complaint_about(R"("type": "sun", "direction": [0, 1, 0], "radiance": 1, "irradiance": 1)"),
      "light 1: radiance and irradiance are given: leave one out");
}

TEST(LightsFile, AParseErrorSaysItsLineAndColumn) {
  const std::string message = complaint("{\n  \"lights\": [,]\n}");
  EXPECT_EQ(message.find("parse error at line 2, column 14: "), 0u) << message;
  EXPECT_EQ(complaint("").find("parse error at line 1, column 1: "), 0u);
}

TEST(LightsFile, AFileThatIsNoLightsFileIsRefused) {
  EXPECT_EQ(complaint("[]"), "must be an object with an array \"lights\"");
  EXPECT_EQ(complaint("{\"lights\": {}}"), "must be an object with an array \"lights\"");
  EXPECT_EQ(complaint_about_path("/nonexistent/lights.json"), "no such lights file");
  EXPECT_EQ(complaint_about_path(std::filesystem::temp_directory_path().string()),
            "is a folder, not a file");
}

TEST(LightsFile, APipeIsRefusedWithoutWaitingForIt) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("dapple_fifo_" + std::to_string(getpid())))
          .string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(complaint_about_path(path), "is not a regular file");
  std::filesystem::remove(path);
}

TEST(LightsFile, DeepNestingAndHugeFilesAreRefused) {
  EXPECT_EQ(complaint(std::string(1'000'000, '[')), "nests deeper than 16 levels");
  const LightsFile file("{");
  std::filesystem::resize_file(file.path(), (16u << 20) + 1);  // a sparse file
  EXPECT_EQ(complaint_about_path(file.path()),
            "is too large (16,777,217 bytes; a lights file may have 16,777,216)");
}

TEST(LightsFile, TheExampleInScenesLoads) {
  const auto lights = load_lights(DAPPLE_SCENES "/studio_lights.json");
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].name, "key");
}

}  // namespace
}  // namespace dapple
