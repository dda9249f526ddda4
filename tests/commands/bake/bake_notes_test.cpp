// What dapple bake tells about its output: what viewers make of a channel, which texture
// coordinates it wrote, which values miss the target, and the statistics of meshes alone.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class BakeNotes : public BakeCommand {
 protected:
  /// What a bake of in.glb to out.glb prints on the standard error.
  [[nodiscard]] std::string notes_of(const std::string& options) const {
    const Outcome run = dapple("bake in.glb -o out.glb --rays 8 " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err;
  }
};

TEST_F(BakeNotes, SayWhichColourOneComponentTakesAway) {
  write("in.glb", rich_triangle().glb());
  for (const auto& [component, color] : {std::pair{"r", "red"}, {"g", "green"}, {"b", "blue"}}) {
    const std::string channel = std::string("COLOR_0.") + component,
                      notes = notes_of("--channel " + channel);
    EXPECT_TRUE(contains(notes, "note: " + channel + " is " + color +
                                    " in glTF: where AO is low, viewers show less " + color))
        << notes;
  }
  for (const char* channel : {"COLOR_0.rgb", "_AO", "TEXCOORD_0.x"})
    EXPECT_FALSE(contains(notes_of(std::string("--channel ") + channel), "in glTF")) << channel;
}

TEST_F(BakeNotes, SayThatColoursOfTheFileAreMultiplied) {
  const std::string note =
      "note: COLOR_0 of the file is multiplied by AO; if it holds baked AO already, use --blend "
      "replace\n";
  write("in.glb", rich_triangle().glb());
  EXPECT_FALSE(contains(notes_of(""), note)) << "there are no colours";
  std::filesystem::rename(path("out.glb"), path("in.glb"));
  for (const auto& [options, is_told] :
       std::map<std::string, bool>{{"", true},
                                   {"--channel COLOR_0.g", true},
                                   {"--channel COLOR_0.a", false},  // the file's has no alpha
                                   {"--blend replace", false},
                                   {"--channel _AO", false},
                                   {"--to texture --size 16", false}})
    EXPECT_EQ(contains(notes_of(options), note), is_told) << options;
}

/// Two triangles as primitives of one mesh, with so many sets of texture coordinates each.
GltfBuilder with_uv_sets(int first, int second) {
  GltfBuilder builder;
  builder.add_triangle();
  json primitives = json::array();
  for (const int sets : {first, second}) {
    json primitive = builder.doc["meshes"][0]["primitives"][0];
    const float x = primitives.empty() ? 0 : 3;
    primitive["attributes"]["POSITION"] = builder.add_positions({x, 0, 0, x + 1, 0, 0, x, 1, 0});
    for (int set = 0; set < sets; ++set)
      primitive["attributes"]["TEXCOORD_" + std::to_string(set)] =
          builder.add_accessor(std::vector<float>{0, 0, 2, 0, 0, 2}, test::kFloat, "VEC2");
    primitives.push_back(primitive);
  }
  builder.doc["meshes"][0]["primitives"] = primitives;
  return builder;
}

TEST_F(BakeNotes, NameTheTextureCoordinatesThatWereMade) {
  struct Case {
    int first, second;
    std::string options, note;
  };
  const std::string own = "the texture has coordinates of its own, ",
                    beyond = "; glTF viewers need not read sets beyond TEXCOORD_1";
  for (const Case& c :
       {Case{0, 0, "", "note: " + own + "TEXCOORD_0\n"},
        Case{1, 1, "", "note: TEXCOORD_0 leaves the texture: " + own + "TEXCOORD_1\n"},
        Case{1, 1, "--uv own", "note: " + own + "TEXCOORD_1\n"},
        Case{
            0, 1, "",
            "note: primitive 0 of mesh 0 has no TEXCOORD_0: " + own + "TEXCOORD_0 or TEXCOORD_1\n"},
        Case{2, 2, "--uv own", "note: " + own + "TEXCOORD_2" + beyond + "\n"},
        Case{2, 0, "",
             "note: primitive 1 of mesh 0 has no TEXCOORD_1; primitive 1 of mesh 0 has no "
             "TEXCOORD_0: " +
                 own + "TEXCOORD_0 or TEXCOORD_2" + beyond + "\n"}}) {
    write("in.glb", with_uv_sets(c.first, c.second).glb());
    const std::string notes = notes_of("--to texture --size 64 --margin 1 " + c.options);
    EXPECT_TRUE(contains(notes, c.note)) << notes << "instead of " << c.note;
    const json mesh = document("out.glb")["meshes"][0];
    EXPECT_TRUE(
        mesh["primitives"][0]["attributes"].contains("TEXCOORD_" + std::to_string(c.first)));
  }
}

TEST_F(BakeNotes, SayThatOcclusionTexturesOfTheFileAreReplaced) {
  GltfBuilder builder = rich_triangle();
  const std::string note =
      "note: 1 material had an occlusion texture, which is replaced; strength and extras stay\n";
  const int image = builder.add("images", {{"uri", "missing.png"}});
  const int texture = builder.add("textures", {{"source", image}});
  const int material = builder.add("materials", {{"name", "leaf"}});
  builder.doc["meshes"][0]["primitives"][0]["material"] = material;
  write("in.glb", builder.glb());
  EXPECT_FALSE(contains(notes_of("--to texture --size 16"), note)) << "there is none";
  builder.doc["materials"][material]["occlusionTexture"] = {
      {"index", texture}, {"strength", 0.25}, {"extras", {{"by", "hand"}}}};
  write("in.glb", builder.glb());
  EXPECT_TRUE(contains(notes_of("--to texture --size 16"), note));
  const json after = document("out.glb")["materials"][material]["occlusionTexture"];
  EXPECT_NE(after["index"], texture);
  EXPECT_EQ(after["strength"], 0.25);
  EXPECT_EQ(after["extras"], (json{{"by", "hand"}}));
  EXPECT_FALSE(contains(notes_of("--channel _AO"), "occlusion texture"));
}

TEST_F(BakeNotes, PrimitivesMayDifferInSetsIfTheChannelIsOrFollowsTheirs) {
  write("in.glb", with_uv_sets(1, 2).glb());
  std::ignore = notes_of("--channel TEXCOORD_1.x");
  const test::GltfData out(path("out.glb"));
  const json primitives = out.doc["meshes"][0]["primitives"];
  const auto added = out.floats(primitives[0]["attributes"]["TEXCOORD_1"]);
  EXPECT_EQ(added, (std::vector<float>{1, 0, 1, 0, 1, 0}));
  const auto replaced = out.floats(primitives[1]["attributes"]["TEXCOORD_1"]);
  EXPECT_EQ(replaced, (std::vector<float>{1, 0, 1, 0, 1, 2}));
  std::filesystem::remove(path("out.glb"));
  write("in.glb", with_uv_sets(0, 1).glb());
  expect_failure(dapple("bake in.glb -o out.glb --channel TEXCOORD_1.x"), 2,
                 "mesh 0 primitive 0 has 0 sets of texture coordinates; TEXCOORD_0 is the next "
                 "one. Others have up to 1: an attribute such as _AO fits all");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(BakeNotes, SayHowManyValuesMissTheTarget) {
  const std::string tree = "bake 'scene:tree?leaves=20' -o out.glb ";
  const Outcome few = dapple(tree + "--target-error 0.001 --rays 16");
  ASSERT_EQ(few.code, 0) << few.err;
  EXPECT_TRUE(contains(few.err,
                       "note: 100.0 % of the values have an error above --target-error 0.001: the "
                       "limit is --rays 16\n"))
      << few.err;
  const Outcome texture = dapple(tree + "--to texture --size 128 --target-error 0.001 --rays 16");
  EXPECT_TRUE(contains(texture.err, "above --target-error 0.001: the limit")) << texture.err;
  for (const char* options : {"", "--rays 16", "--target-error 0.5 --rays 8"}) {
    const Outcome run = dapple(tree + options);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_FALSE(contains(run.err, "--target-error")) << run.err;
  }
}

TEST_F(BakeNotes, SayHowManyInstancesMissTheTarget) {
  const std::string forest =
      "bake 'scene:forest?trees=3&leaves=100' -o out.glb --to instance --stats-json s.json ";
  const Outcome few = dapple(forest + "--target-error 0.0001 --rays 16");
  ASSERT_EQ(few.code, 0) << few.err;
  EXPECT_TRUE(contains(few.err,
                       "% of the values have an error above --target-error 0.0001: the limit is "
                       "--rays 16\n"))
      << few.err;
  json statistics = json::parse(bytes_of(path("s.json")));
  EXPECT_EQ(statistics["ao_target"]["values"], 4) << "the ground is one";
  EXPECT_GE(statistics["ao_target"]["above"], 3);
  EXPECT_EQ(statistics["light_target"], json({{"values", 0}, {"above", 0}}));
  for (const char* options : {"", "--rays 16"}) {
    const Outcome run = dapple(forest + options);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_FALSE(contains(run.err, "--target-error")) << run.err;
    statistics = json::parse(bytes_of(path("s.json")));
    EXPECT_EQ(statistics["ao_target"]["above"], 0) << options;
  }
}

TEST_F(BakeNotes, StatisticsHaveTheTargetOfVerticesAndTexels) {
  write("in.glb", rich_triangle().glb());
  for (const char* to : {"vertex", "texture --size 8"}) {
    const Outcome run =
        dapple("bake in.glb -o out.glb --stats-json s.json --to " + std::string(to));
    ASSERT_EQ(run.code, 0) << run.err;
    const json counts = json::parse(bytes_of(path("s.json")))["ao_target"];
    EXPECT_GE(counts["values"], 3) << to;
    EXPECT_EQ(counts["above"], 0) << to;
  }
}

TEST_F(BakeNotes, TheStandardErrorIsThatOfVerticesOfTrianglesWithAnArea) {
  std::map<bool, double> error;
  for (const bool more : {false, true}) {
    GltfBuilder builder;
    builder.add_triangle();
    std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    if (more) positions.insert(positions.end(), 9, 0.5f);
    std::vector<std::uint16_t> corners{0, 1, 2};
    if (more) corners.insert(corners.end(), {3, 4, 5});
    json& primitive = builder.doc["meshes"][0]["primitives"][0];
    primitive["attributes"] = {{"POSITION", builder.add_positions(positions)}};
    primitive["indices"] = builder.add_accessor(corners, test::kUint16, "SCALAR");
    write("in.glb", builder.glb());
    std::ignore = notes_of("--stats-json s.json");
    error[more] = json::parse(bytes_of(path("s.json")))["standard_error"].get<double>();
  }
  EXPECT_GT(error[false], 0);
  EXPECT_DOUBLE_EQ(error[true], error[false]);
}

TEST_F(BakeNotes, StatisticsOfMeshesAloneHaveTheDeviceAndTheTimeOfBuilding) {
  write("in.glb", rich_triangle().glb());
  std::map<std::string, json> statistics;
  for (const std::string instances : {"alone", "together"}) {
    std::ignore = notes_of("--stats-json s.json --instances " + instances);
    statistics[instances] = json::parse(bytes_of(path("s.json")));
  }
  const json &alone = statistics["alone"], &together = statistics["together"];
  EXPECT_EQ(alone["device"], together["device"]);
  EXPECT_FALSE(alone["device"].get<std::string>().empty());
  const json& seconds = alone["seconds"];
  for (const char* key : {"build", "upload"}) EXPECT_GT(seconds[key].get<double>(), 0) << seconds;
}

TEST_F(BakeNotes, SecondsAddUpToTheirTotal) {
  for (const char* instances : {"alone", "together"}) {
    const Outcome run =
        dapple(std::string("bake 'scene:tree?leaves=20000' -o out.glb --rays 8 --stats-json s.json "
                           "--instances ") +
               instances);
    ASSERT_EQ(run.code, 0) << run.err;
    const json seconds = json::parse(bytes_of(path("s.json")))["seconds"];
    double sum = 0;
    for (const char* key :
         {"load", "prepare", "build", "upload", "kernel_build", "trace", "write"}) {
      EXPECT_GE(seconds[key].get<double>(), 0) << key;
      sum += seconds[key].get<double>();
    }
    const double total = seconds["total"].get<double>();
    EXPECT_NEAR(sum, total, 0.01 + 0.05 * total) << seconds;
  }
}

TEST_F(BakeNotes, OptionsThatMeshesAloneIgnoreAreRefused) {
  write("in.glb", rich_triangle().glb());
  write("wall.glb", rich_triangle().glb());
  const std::string alone = "bake in.glb -o out.glb --instances alone ";
  expect_failure(dapple(alone + "--ground"), 2, "--ground needs --instances together or unique");
  expect_failure(dapple(alone + "--occluders wall.glb"), 2,
                 "--occluders needs --instances together or unique");
  EXPECT_EQ(files_in_folder(), 2u);
}

}  // namespace
}  // namespace dapple
