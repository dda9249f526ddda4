// dapple bake of lights: where their irradiance is in the file, and which lights there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dapple/scene.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

TEST_F(BakeCommand, LightsAreAttributesWithTheirNames) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("lights.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, 0, -1], "irradiance": [1, 0.5, 0.25]}]})";
  const Outcome run = dapple("bake in.glb -o out.glb --passes ao,light --lights lights.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData after(path("out.glb"));
  const json& attributes = after.doc["meshes"][0]["primitives"][0]["attributes"];
  ASSERT_TRUE(attributes.contains("_LIGHT_noon")) << attributes;
  EXPECT_EQ(after.accessor(attributes["_LIGHT_noon"])["type"], "VEC3");
  const std::vector<float> rgb = after.floats(attributes["_LIGHT_noon"]);
  ASSERT_EQ(rgb.size(), 9u);
  for (std::size_t i = 0; i < rgb.size(); ++i)
    EXPECT_NEAR(rgb[i], std::pow(0.5, i % 3), 1e-3)
        << "vertex " << i / 3 << ", component " << i % 3;
  EXPECT_EQ(run.err.find("earlier bake"), std::string::npos) << run.err;
  std::ofstream(path("dusk.json")) << R"({"lights": [{"type": "sun", "name": "dusk",
      "direction": [0, 0, -1], "irradiance": 1}]})";
  const Outcome again = dapple("bake out.glb -o b.glb --passes ao,light --lights dusk.json");
  EXPECT_NE(again.err.find("keeps _LIGHT_noon of an earlier bake"), std::string::npos) << again.err;
  expect_failure(dapple("bake in.glb -o no.glb --passes ao,light"), 2, "--lights");
  expect_failure(dapple("bake in.glb -o no.glb --lights lights.json"), 2, "--passes");
  expect_failure(dapple("bake in.glb -o no.glb --passes light,shine"), 2, "--passes");
  EXPECT_FALSE(std::filesystem::exists(path("no.glb")));
}

TEST_F(BakeCommand, TexturesHoldSixteenBitsAndTheirLightsAreInAnExr) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, 0, -1], "irradiance": [1, 0.5, 0.25]}]})";
  const Outcome run = dapple(
      "bake in.glb -o out.gltf --to texture --size 16 --bits 16 --passes ao,light --lights "
      "sun.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string png = bytes_of(path("out_ao.png"));
  EXPECT_EQ(png.substr(24, 2), std::string("\x10\0", 2)) << "16 bits, grey";
  const Film film = read_exr(path("out_baked.exr"));
  ASSERT_NE(film.find("ao"), nullptr);
  for (const auto& [channel, expected] :
       {std::pair{"light.noon.R", 1.0}, {"light.noon.G", 0.5}, {"light.noon.B", 0.25}}) {
    ASSERT_NE(film.find(channel), nullptr) << channel;
    EXPECT_NEAR(film.find(channel)->pixels.at(16 * 15), expected, 1e-3) << channel;
  }
  expect_failure(dapple("bake in.glb -o no.glb --to texture --bits 12"), 2, "--bits");
  ASSERT_EQ(dapple("bake in.glb -o out.glb --to texture --size 16 --stats-json s.json").code, 0);
  const json statistics = json::parse(bytes_of(path("s.json")));
  EXPECT_GT(statistics["texture"]["coverage"].get<double>(), 0.2);
}

TEST_F(BakeCommand, ADomeStandsBesideTheLightsOfTheScene) {
  GltfBuilder builder = rich_triangle();
  builder.doc["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.doc["meshes"][1]["primitives"][0]["material"] = 0;
  builder.add(
      "nodes",
      {{"name", "lamp"}, {"mesh", 1}, {"translation", {0, 0, 2}}, {"rotation", {1, 0, 0, 0}}});
  write("in.glb", builder.glb());
  Film sky;
  sky.width = sky.height = 2;
  sky.data_window = {0, 0, 1, 1};
  for (const char* channel : {"R", "G", "B"}) sky.planes.push_back({channel, {1, 1, 1, 1}});
  write_exr(sky, path("sky.exr"));
  const Outcome run = dapple("bake in.glb -o out.glb --passes ao,light --dome sky.exr");
  ASSERT_EQ(run.code, 0) << run.err;
  const json attributes = document("out.glb")["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("_LIGHT_lamp")) << attributes;
  EXPECT_TRUE(attributes.contains("_LIGHT_dome")) << attributes;
}

/// An image of a warm colour that is bright towards +Z: up to 45 degrees to the sides, and up and
/// down.
void write_sky(const std::string& path) {
  Film sky;
  sky.width = 8;
  sky.height = 4;
  sky.data_window = {0, 0, 7, 3};
  float brightness = 1;
  for (const char* channel : {"R", "G", "B"}) {
    std::vector<float> pixels(32, 0.01f * brightness);
    for (const std::size_t i : {11u, 12u, 19u, 20u}) pixels[i] = 10 * brightness;
    sky.planes.push_back({channel, pixels});
    brightness /= 2;
  }
  write_exr(sky, path);
}

/// The red irradiance of a surface that faces the bright part of write_sky(). There the cosine's
/// integral over the angle to the side is sqrt(2), and that of its square over the elevation
/// pi / 4 + 1 / 2; over the whole hemisphere both make pi.
double irradiance_facing_the_bright_part() {
  const double bright = std::sqrt(2.0) * (std::numbers::pi / 4 + 0.5);
  return 10 * bright + 0.01 * (std::numbers::pi - bright);
}

class BakeUnderADome : public BakeCommand {
 protected:
  BakeUnderADome() { write_sky(path("sky.exr")); }

  /// Red, green and blue at the first vertex of in.glb.
  [[nodiscard]] std::vector<float> irradiance(const std::string& rotation) const {
    const Outcome run = dapple(
        "bake in.glb -o out.glb --passes ao,light --dome sky.exr --sides front --rays 4096 "
        "--light-rays 64 " +
        rotation);
    EXPECT_EQ(run.code, 0) << run.err;
    const test::GltfData file(path("out.glb"));
    return file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["_LIGHT_dome"]);
  }
};

TEST_F(BakeUnderADome, ADomeMayBeTurnedAndKeepsItsColour) {
  write("in.glb", rich_triangle().glb());  // faces +Z
  const std::vector<float> facing = irradiance("");
  // Over 2,000 rays that deviate by half: 1 % at one sigma.
  const double expected = irradiance_facing_the_bright_part();
  EXPECT_NEAR(facing.at(0), expected, 0.05 * expected);
  EXPECT_NEAR(facing.at(1), facing[0] / 2, 1e-3 * expected);
  EXPECT_NEAR(facing.at(2), facing[0] / 4, 1e-3 * expected);
  EXPECT_NEAR(irradiance("--dome-rotation 360").at(0), facing[0], 0.02 * expected);
  EXPECT_LT(irradiance("--dome-rotation 180").at(0), 0.1f);
  expect_failure(dapple("bake in.glb -o no.glb --passes ao,light --dome-rotation 3"), 2,
                 "--dome-rotation needs --dome");
}

TEST_F(BakeUnderADome, APositiveRotationTurnsPlusZTowardsPlusX) {
  GltfBuilder builder = rich_triangle();
  const double half = std::sqrt(0.5);
  builder.doc["nodes"][0]["rotation"] = {0, half, 0, half};  // by 90 degrees about +Y: faces +X
  write("in.glb", builder.glb());
  const double expected = irradiance_facing_the_bright_part();
  EXPECT_NEAR(irradiance("--dome-rotation=90").at(0), expected, 0.05 * expected);
  EXPECT_LT(irradiance("--dome-rotation=-90").at(0), 0.1f);
}

TEST_F(BakeCommand, AFileWithoutLightsStandsInPlaceOfTheScenes) {
  std::ofstream(path("none.json")) << R"({"lights": []})";
  expect_failure(dapple("bake 'scene:demo' -o out.glb --passes ao,light --lights none.json"), 2,
                 "none.json has no lights");
  EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
}

TEST_F(BakeCommand, ImagesThatALightsFileNamesAreNotOverwritten) {
  write("in.glb", rich_triangle().glb());
  write_sky(path("sky.exr"));
  std::ofstream(path("dome.json"))
      << R"({"lights": [{"type": "dome", "name": "sky", "image": "sky.exr"}]})";
  const std::string before = bytes_of(path("sky.exr"));
  const Outcome run =
      dapple("bake in.glb -o out.glb --passes ao,light --lights dome.json --stats-json sky.exr");
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(contains(run.err, "sky.exr")) << run.err;
  EXPECT_EQ(bytes_of(path("sky.exr")), before);
}

TEST_F(BakeCommand, AChannelIsNotTheAttributeOfALight) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("sun.json"))
      << R"({"lights": [{"type": "sun", "name": "AO", "direction": [0, 0, -1],
      "irradiance": 1}]})";
  const std::string lit = "bake in.glb -o out.glb --passes ao,light --lights sun.json --channel ";
  expect_failure(dapple(lit + "_LIGHT_AO"), 2,
                 "--channel is _LIGHT_AO, which is the attribute of the light \"AO\"");
  EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
  EXPECT_EQ(dapple(lit + "_LIGHT").code, 0);
  EXPECT_EQ(dapple("bake in.glb -o out.glb --channel _LIGHT_AO").code, 0);
}

}  // namespace
}  // namespace dapple
