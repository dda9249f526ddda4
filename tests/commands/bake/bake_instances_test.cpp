// dapple bake of scenes with several instances of a mesh: values of each instance, and unique
// meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "dapple/scene.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

TEST_F(BakeCommand, UniqueInstancesHaveMeshesAndValuesOfTheirOwn) {
  // Two placements of a triangle, one of them under a large one.
  GltfBuilder builder;
  builder.add_triangle();
  builder.doc["nodes"].push_back({{"mesh", 0}, {"translation", {100, 0, 0}}});
  builder.doc["nodes"].push_back(
      {{"mesh", 1}, {"translation", {0, 0, 0.01}}, {"scale", {50, 50, 1}}});
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.doc["scenes"][0]["nodes"] = {0, 1, 2};
  write("in.glb", builder.glb());
  ASSERT_EQ(dapple("bake in.glb -o out.glb --channel _AO --sides mean --instances unique "
                   "--estimator exact --rays 1024 --png out.png")
                .code,
            0);
  const json after = document("out.glb");
  ASSERT_EQ(after["meshes"].size(), 3u);
  EXPECT_EQ(after["nodes"][0]["mesh"], 0);
  EXPECT_EQ(after["nodes"][1]["mesh"], 2);
  const auto attributes = [&](int mesh) {
    return after["meshes"][mesh]["primitives"][0]["attributes"];
  };
  EXPECT_EQ(attributes(0)["POSITION"], attributes(2)["POSITION"]) << "positions are shared";
  const auto ao_of = [&](int mesh) {
    return test::GltfData(path("out.glb")).floats(attributes(mesh)["_AO"]);
  };
  // The large triangle hides all from one side of the first placement but for 0.03, near edges.
  for (const float ao : ao_of(0)) EXPECT_NEAR(ao, 0.5f, 0.1f);
  for (const float ao : ao_of(2)) EXPECT_GT(ao, 0.99f);
  EXPECT_TRUE(std::filesystem::exists(path("out.png")));
  // Together they share the mean: of fronts, almost 0 and 1.
  ASSERT_EQ(dapple("bake in.glb -o out.glb --channel _AO --rays 1024").code, 0);
  const test::GltfData together(path("out.glb"));
  ASSERT_EQ(together.doc["meshes"].size(), 2u);
  for (const float ao :
       together.floats(together.doc["meshes"][0]["primitives"][0]["attributes"]["_AO"]))
    EXPECT_NEAR(ao, 0.5f, 0.1f);
}

TEST_F(BakeCommand, UniqueInstancesOfAnExtensionBecomeNodes) {
  // A triangle twice, once close under a large one.
  GltfBuilder builder;
  builder.add_triangle();
  const int places =
      builder.add_accessor(std::vector<float>{0, 0, 0, 100, 0, 0}, test::kFloat, "VEC3");
  const int ids = builder.add_accessor(std::vector<float>{7, 8}, test::kFloat, "SCALAR");
  builder.doc["nodes"][0]["name"] = "twice";
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}, {"_ID", ids}};
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.add("nodes", {{"mesh", 1}, {"translation", {0, 0, 0.01}}, {"scale", {50, 50, 1}}});
  write("in.glb", builder.glb());
  const Outcome run =
      dapple("bake in.glb -o out.glb --channel _AO --sides mean --instances unique");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  const json& node = after["nodes"][0];
  EXPECT_FALSE(node.contains("mesh"));
  EXPECT_FALSE(node.contains("extensions"));
  EXPECT_FALSE(after.contains("extensionsUsed"));
  ASSERT_EQ(node["children"].size(), 2u);
  const json &near = after["nodes"][node["children"][0].get<std::size_t>()],
             &far = after["nodes"][node["children"][1].get<std::size_t>()];
  EXPECT_EQ(far["translation"], (json{100, 0, 0}));
  EXPECT_EQ(far["extras"]["_ID"], json{8});
  const auto least_ao = [&](const json& of) {
    const json& mesh = after["meshes"][of["mesh"].get<std::size_t>()];
    const std::vector<float> ao =
        test::GltfData(path("out.glb")).floats(mesh["primitives"][0]["attributes"]["_AO"]);
    return *std::min_element(ao.begin(), ao.end());
  };
  EXPECT_LT(least_ao(near), 0.8f);
  EXPECT_FLOAT_EQ(least_ao(far), 1);
  const Scene before = load_gltf(path("in.glb")), scene = load_gltf(path("out.glb"));
  EXPECT_EQ(scene.instances.size(), before.instances.size());
  EXPECT_EQ(scene_bounds(scene), scene_bounds(before));
}

// The list of used extensions ends with the last instances, and other keys of the file take its
// place.
TEST_F(BakeCommand, UniqueInstancesOfALaterNodeLeaveTheRestOfTheFile) {
  GltfBuilder builder;
  builder.add_triangle();
  const int places =
      builder.add_accessor(std::vector<float>{0, 0, 0, 100, 0, 0}, test::kFloat, "VEC3");
  json node = builder.doc["nodes"][0];
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}};
  builder.doc["nodes"] = {{{"name", "a"}}, {{"name", "b"}}, {{"name", "c"}}, node, node};
  builder.doc["scenes"] = {{{"nodes", {0, 1, 2, 3, 4}}}};
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --instances unique --rays 8");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  EXPECT_EQ(after["scenes"], builder.doc["scenes"]);
  EXPECT_EQ(after["nodes"].size(), 9u);
  for (const json& each : after["nodes"]) EXPECT_FALSE(each.contains("extensions")) << each;
  EXPECT_EQ(load_gltf(path("out.glb")).instances.size(), 4u);
}

/// A triangle at three places of EXT_mesh_gpu_instancing; `more` are other attributes of them.
GltfBuilder three_instances(const std::function<json(GltfBuilder&)>& more) {
  GltfBuilder builder;
  builder.add_triangle();
  json attributes = more(builder);
  attributes["TRANSLATION"] =
      builder.add_accessor(std::vector<float>{0, 0, 0, 10, 0, 0, 20, 0, 0}, test::kFloat, "VEC3");
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  return builder;
}

TEST_F(BakeCommand, AnimationsOfWeightsMoveTheNodesThatInstancesBecame) {
  GltfBuilder builder;
  builder.add_triangle();
  const int shift = builder.add_accessor(std::vector<float>(9, 0.1f), test::kFloat, "VEC3");
  builder.doc["accessors"].back()["min"] =
      builder.doc["accessors"].back()["max"] = {0.1f, 0.1f, 0.1f};
  builder.doc["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", shift}}};
  json& node = builder.doc["nodes"][0];
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      builder.add_accessor(std::vector<float>{0, 0, 0, 9, 0, 0}, test::kFloat, "VEC3");
  node["extensions"]["EXT_instance_features"]["featureIds"] = {{{"featureCount", 2}}};
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing", "EXT_instance_features"};
  const int times = builder.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
  builder.doc["accessors"].back()["min"] = {0};
  builder.doc["accessors"].back()["max"] = {1};
  const int weights = builder.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
  builder.add("animations",
              {{"samplers", {{{"input", times}, {"output", weights}}}},
               {"channels",
                {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}},
                 {{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  builder.doc["animations"][0]["channels"].erase(1);
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --instances unique");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find("EXT_instance_features of instances that became nodes is left out"),
            std::string::npos)
      << run.err;
  const json after = document("out.glb");
  EXPECT_FALSE(after["nodes"][0].contains("extensions"));
  EXPECT_FALSE(after.contains("extensionsUsed"));
  json moved = json::array();
  for (const json& channel : after["animations"][0]["channels"]) {
    EXPECT_EQ(channel["target"]["path"], "weights");
    moved.push_back(channel["target"]["node"]);
  }
  EXPECT_EQ(moved, after["nodes"][0]["children"]);
}

TEST_F(BakeCommand, NodesOfInstancesHaveUnitRotations) {
  const auto rotations = [](GltfBuilder& builder) {
    return json{{"ROTATION", builder.add_accessor(
                                 std::vector<std::int8_t>{0, 0, 0, 0, 0, 64, 0, 64, 0, 0, 0, 127},
                                 test::kInt8, "VEC4", true)}};
  };
  write("in.glb", three_instances(rotations).glb());
  const Outcome run = dapple("bake in.glb -o out.glb --instances unique");
  ASSERT_EQ(run.code, 0) << run.err;
  const json nodes = document("out.glb")["nodes"];
  EXPECT_EQ(nodes[1]["rotation"], (json{0, 0, 0, 1}));
  EXPECT_NEAR(nodes[2]["rotation"][1].get<double>(), std::sqrt(0.5), 1e-6);
  EXPECT_EQ(scene_bounds(load_gltf(path("out.glb"))), scene_bounds(load_gltf(path("in.glb"))));
}

TEST_F(BakeCommand, InstancesThatAreNotFiniteGetNoNodes) {
  const auto scales = [](GltfBuilder& builder) {
    return json{{"SCALE", builder.add_accessor(std::vector<float>{1, 1, 1, 1, NAN, 1, 2, 2, 2},
                                               test::kFloat, "VEC3")}};
  };
  write("in.glb", three_instances(scales).glb());
  const Outcome run = dapple("bake in.glb -o out.glb --instances unique");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "not finite are left out (1 of them)")) << run.err;
  const json after = document("out.glb");
  EXPECT_EQ(after["nodes"][0]["children"], (json{1, 2}));
  EXPECT_EQ(after["nodes"][2]["scale"], (json{2, 2, 2}));
  EXPECT_EQ(after["meshes"].size(), 2u);
  EXPECT_EQ(load_gltf(path("out.glb")).instances.size(), 2u);
  // The accessor that is not valid is in both.
  for (const char* name : {"in.glb", "out.glb"}) std::filesystem::remove(path(name));
}

TEST_F(BakeCommand, ExtrasOfInstancesThatAreNotObjectsAreKept) {
  GltfBuilder builder = rich_triangle();
  builder.doc["nodes"][0]["extras"] = "tall";
  for (const json& extras : {json{1, 2}, json(), json{{"kind", "fern"}, {"ao", 0.5}}})
    builder.doc["nodes"].push_back({{"mesh", 0}, {"extras", extras}});
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to instance");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err,
                       "note: node 0 (\"twig\") has extras that are not an object; they are kept "
                       "as extras.value (2 of them)\n"))
      << run.err;
  EXPECT_TRUE(
      contains(run.err, "note: node 3 had baked values in its extras, which are replaced\n"));
  const json nodes = document("out.glb")["nodes"];
  for (const json& node : nodes) EXPECT_TRUE(node["extras"].contains("ao")) << node;
  EXPECT_EQ(nodes[0]["extras"]["value"], "tall");
  EXPECT_EQ(nodes[1]["extras"]["value"], (json{1, 2}));
  EXPECT_EQ(nodes[2]["extras"].size(), 1u);
  EXPECT_EQ(nodes[3]["extras"]["kind"], "fern");
  EXPECT_NE(nodes[3]["extras"]["ao"], 0.5);
}

TEST_F(BakeCommand, InstancesGetExtrasOrAnInstanceAttribute) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0, -3}}});
  const int places =
      builder.add_accessor(std::vector<float>{5, 0, 0, 7, 0, 0}, test::kFloat, "VEC3");
  builder.add(
      "nodes",
      {{"mesh", 0},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to instance");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find("1 triangles, 4 instances"), std::string::npos) << run.out;
  const json after = document("out.glb");
  EXPECT_GT(after["nodes"][0]["extras"]["ao"].get<double>(), 0.5);
  EXPECT_GT(after["nodes"][1]["extras"]["ao"].get<double>(), 0.5);
  const json& attributes = after["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  EXPECT_EQ(after["accessors"][attributes["_AO"].get<std::size_t>()]["count"], 2);
  EXPECT_EQ(load_gltf(path("out.glb")).instances.size(), 4u);
}

/// A triangle at two places of EXT_mesh_gpu_instancing that has colours, and at one of a node.
GltfBuilder coloured_instances() {
  GltfBuilder builder;
  builder.add_triangle();
  const int places =
      builder.add_accessor(std::vector<float>{0, 0, 0, 0, 0, 0.1f}, test::kFloat, "VEC3");
  const int colors =
      builder.add_accessor(std::vector<float>{1, 0, 0, 0, 1, 0}, test::kFloat, "VEC3");
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}, {"_COLOR_0", colors}};
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 9}}});
  return builder;
}

TEST_F(BakeCommand, TheColourOfInstancesIsGreyAoAndOtherChannelsAreScalars) {
  write("in.glb", coloured_instances().glb());
  std::map<std::string, std::vector<float>> values;
  for (const std::string channel : {"_AO", "_COLOR_0", "_SHADE"}) {
    const std::string option = channel == "_AO" ? "" : " --channel " + channel;
    const Outcome run = dapple("bake in.glb -o out.glb --to instance" + option);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_FALSE(contains(run.err, "extras.ao")) << run.err;
    const test::GltfData file(path("out.glb"));
    const json& node = file.doc["nodes"][0];
    EXPECT_FALSE(node.contains("extras")) << node;
    EXPECT_TRUE(file.doc["nodes"][1]["extras"]["ao"].is_number()) << file.doc["nodes"][1];
    const json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    EXPECT_EQ(attributes.contains("_AO"), channel == "_AO") << attributes;
    const json& accessor = file.accessor(attributes.at(channel));
    EXPECT_EQ(accessor["type"], channel == "_COLOR_0" ? "VEC3" : "SCALAR");
    EXPECT_EQ(accessor["componentType"], test::kFloat);
    values[channel] = file.floats(attributes.at(channel));
  }
  const std::vector<float>& ao = values["_AO"];
  ASSERT_EQ(ao.size(), 2u);
  EXPECT_LT(ao[0], 0.5f) << "the other one is close above it";
  EXPECT_GT(ao[1], 0.9f);
  EXPECT_EQ(values["_SHADE"], ao);
  EXPECT_EQ(values["_COLOR_0"], (std::vector<float>{ao[0], ao[0], ao[0], ao[1], ao[1], ao[1]}));
}

TEST_F(BakeCommand, ChannelsThatInstancesCannotHaveAreRefusedAndThoseThatNoneHasTold) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, 0, -1], "irradiance": 1}]})";
  const std::string bake = "bake in.glb -o out.glb --to instance --channel ";
  for (const char* channel : {"COLOR_0.rgb", "COLOR_0.r", "TEXCOORD_1.x", "TRANSLATION", "_"})
    expect_failure(dapple(bake + channel), 2, "with --to instance it can be _AO, _COLOR_0");
  expect_failure(dapple(bake + "_LIGHT_noon --passes ao,light --lights sun.json"), 2,
                 "the attribute of the light \"noon\"");
  EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
  const Outcome run = dapple(bake + "_COLOR_0");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "there is no _COLOR_0, all values are extras.ao")) << run.err;
  EXPECT_TRUE(document("out.glb")["nodes"][0]["extras"]["ao"].is_number());
}

// Viewers transform normals with the inverse transpose: a direction b of a mesh that is scaled by S
// is shown where the normal S^2 b is. A wall hides a part of the sky.
TEST_F(BakeCommand, BentNormalsInNormalShowTheirDirectionUnderAnyScale) {
  GltfBuilder builder = rich_triangle();
  builder.doc["nodes"][0].update({{"scale", {4, 1, 1}}, {"rotation", {0, 0, 0.5, 0.8660254}}});
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  const double half = std::sqrt(0.5);
  builder.doc["nodes"].push_back({{"mesh", 1},
                                  {"scale", {50, 50, 50}},
                                  {"rotation", {0, -half, 0, half}},
                                  {"translation", {5, -10, -10}}});
  builder.doc["scenes"][0]["nodes"] = {0, 1};
  write("in.glb", builder.glb());
  std::vector<V3f> found;
  for (const std::string channel : {"_BENT_NORMAL", "NORMAL"}) {
    const Outcome run = dapple(
        "bake in.glb -o out.glb --channel _AO --sides front --passes ao,bent --rays 1024 "
        "--bent-channel " +
        channel);
    ASSERT_EQ(run.code, 0) << run.err;
    const test::GltfData file(path("out.glb"));
    const std::vector<float> bent =
        file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"][channel]);
    found.emplace_back(bent[0], bent[1], bent[2]);
  }
  EXPECT_GT(std::fabs(found[0].x), 0.02f) << "the wall hides nothing";
  const V3f expected = V3f(16 * found[0].x, found[0].y, found[0].z).normalized();
  EXPECT_LT((found[1] - expected).length(), 1e-4f) << found[1] << ", not " << expected;
}

TEST_F(BakeCommand, NodesThatAreScaledToZeroGetNoValues) {
  GltfBuilder builder = rich_triangle();
  builder.doc["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}});
  builder.doc["nodes"].push_back({{"mesh", 0}});
  builder.doc["scenes"][0]["nodes"] = {0, 1, 2};
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to instance");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "dropped 1 instance whose matrix cannot be inverted")) << run.err;
  const json nodes = document("out.glb")["nodes"];
  EXPECT_TRUE(nodes[0]["extras"].contains("ao"));
  EXPECT_FALSE(nodes[1].contains("extras"));
  EXPECT_TRUE(nodes[2]["extras"].contains("ao"));
}

TEST_F(BakeCommand, InstancesHaveLightsAsExtras) {
  write("in.glb", rich_triangle().glb());
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, 0, -1], "irradiance": [1, 0.5, 0.25]}]})";
  const Outcome run =
      dapple("bake in.glb -o out.glb --to instance --passes ao,light --lights sun.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const json light = document("out.glb")["nodes"][0]["extras"]["light_noon"];
  ASSERT_EQ(light.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(light[k].get<double>(), std::pow(0.5, k), 1e-3) << "component " << k;
}

}  // namespace
}  // namespace dapple
