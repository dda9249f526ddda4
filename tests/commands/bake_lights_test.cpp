// dapple bake of lights: where their irradiance is in the file, and which lights there are.
#include <gtest/gtest.h>

#include <algorithm>

#include "dapple/scene.hpp"
#include "support/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

TEST_F(BakeCommand, LightsAreAttributesWithTheirNames) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("lights.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, 0, -1], "irradiance": [1, 1, 1]}]})";
  const Outcome run = dapple("bake in.glb -o out.glb --passes ao,light --lights lights.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  const json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  ASSERT_TRUE(attributes.contains("_LIGHT_noon")) << attributes;
  EXPECT_EQ(after["accessors"][attributes["_LIGHT_noon"].get<std::size_t>()]["type"], "VEC3");
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
  for (const char* channel : {"ao", "light.noon.R", "light.noon.G", "light.noon.B"})
    ASSERT_NE(film.find(channel), nullptr) << channel;
  EXPECT_NEAR(film.find("light.noon.G")->pixels.at(16 * 15), 0.5, 1e-3);
  expect_failure(dapple("bake in.glb -o no.glb --to texture --bits 12"), 2, "--bits");
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
