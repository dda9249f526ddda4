// The command dapple bake. The output file keeps everything that the input file had, baked values
// are in the attributes that the options name, and errors leave no file behind.
#include "support/programs/bake_command.hpp"

#include <gtest/gtest.h>

#include <array>

#include "dapple/scene.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

TEST_F(BakeCommand, KeepsEverythingElseInTheFile) {
  write("in.glb", rich_triangle().glb());
  const Outcome run = dapple("bake in.glb -o out.glb");
  ASSERT_EQ(run.code, 0) << run.err;
  json before = document("in.glb"), after = document("out.glb");
  json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  ASSERT_TRUE(attributes.contains("COLOR_0"));
  const json accessor = after["accessors"][attributes["COLOR_0"].get<std::size_t>()];
  EXPECT_EQ(accessor["count"], 3);
  EXPECT_EQ(accessor["type"], "VEC3");
  EXPECT_EQ(accessor["normalized"], true);
  attributes.erase("COLOR_0");
  for (const char* key : {"bufferViews", "accessors"}) {
    after[key].erase(after[key].size() - 1);
    EXPECT_EQ(after[key], before[key]) << key;
  }
  before.erase("buffers");
  after.erase("buffers");
  EXPECT_EQ(after, before);
  const Scene scene = load_gltf(path("out.glb"));
  EXPECT_EQ(scene.meshes.at(0).positions, load_gltf(path("in.glb")).meshes.at(0).positions);
}

TEST_F(BakeCommand, AnAttributeOfItsOwnHoldsTheValuesAndBentNormalsStandBeside) {
  write("in.glb", rich_triangle().glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --passes ao,bent");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  const json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(after["accessors"][attributes["_AO"].get<std::size_t>()]["type"], "SCALAR");
  EXPECT_EQ(after["accessors"][attributes["_BENT_NORMAL"].get<std::size_t>()]["type"], "VEC3");
}

TEST_F(BakeCommand, TextureCoordinatesAndNormalsCanHoldTheValues) {
  write("in.glb", rich_triangle().glb());
  Outcome run = dapple(
      "bake in.glb -o out.glb --channel TEXCOORD_0.y --passes ao,bent "
      "--bent-channel NORMAL");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  const json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(after["accessors"][attributes["TEXCOORD_0"].get<std::size_t>()]["type"], "VEC2");
  EXPECT_EQ(after["accessors"][attributes["NORMAL"].get<std::size_t>()]["type"], "VEC3");
  EXPECT_FALSE(attributes.contains("_BENT_NORMAL"));
  run = dapple("bake in.glb -o late.glb --channel TEXCOORD_1.x");
  expect_failure(run, 2, "TEXCOORD_0 is the next one");
  EXPECT_FALSE(std::filesystem::exists(path("late.glb")));
}

constexpr std::array<float, 4> kColor{0.5f, 1, 0.75f, 0.25f};
constexpr std::array<float, 6> kUvs{0.25f, 0.5f, 0.75f, 0.5f, 0.25f, 0.875f};

/// A triangle with colours and texture coordinates, 1 m below a larger one. Seen from the triangle,
/// the larger one holds a disk of radius 0.7 m and lies in one of 3.6 m: AO is from 0.07 to 0.67.
GltfBuilder shaded_triangle(std::array<float, 4> color = kColor) {
  GltfBuilder builder;
  builder.add_triangle();
  std::vector<float> colors;
  for (int v = 0; v < 3; ++v) colors.insert(colors.end(), color.begin(), color.end());
  json& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = builder.add_accessor(colors, test::kFloat, "VEC4");
  attributes["TEXCOORD_0"] =
      builder.add_accessor(std::vector<float>(kUvs.begin(), kUvs.end()), test::kFloat, "VEC2");
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.add("nodes", {{"mesh", 1}, {"scale", {4, 4, 1}}, {"translation", {-1, -1, 1}}});
  return builder;
}

class BakedChannel : public BakeCommand {
 protected:
  BakedChannel() {
    write("in.glb", shaded_triangle().glb());
    ao_ = baked("--channel _AO", "_AO");
  }

  /// `attribute` of the lower triangle, of `components` numbers, after a bake with `options`.
  [[nodiscard]] std::vector<float> baked(const std::string& options, const char* attribute,
                                         std::size_t components = 1) const {
    const Outcome run = dapple("bake in.glb -o out.glb --rays 1024 " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    const test::GltfData file(path("out.glb"));
    std::vector<float> values =
        file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"].at(attribute));
    EXPECT_EQ(values.size(), 3 * components) << options;
    values.resize(3 * components);
    return values;
  }

  std::vector<float> ao_;  ///< as an attribute of its own
};

TEST_F(BakedChannel, AoIsInTheComponentOfTextureCoordinatesThatIsNamedAndTheOtherStays) {
  const std::vector<float> x = baked("--channel TEXCOORD_0.x", "TEXCOORD_0", 2),
                           y = baked("--channel TEXCOORD_0.y", "TEXCOORD_0", 2),
                           added = baked("--channel TEXCOORD_1.y", "TEXCOORD_1", 2);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_GT(ao_[v], 0.02f);
    EXPECT_LT(ao_[v], 0.8f);
    EXPECT_EQ(x[2 * v], ao_[v]);
    EXPECT_EQ(x[2 * v + 1], kUvs[2 * v + 1]);
    EXPECT_EQ(y[2 * v], kUvs[2 * v]);
    EXPECT_EQ(y[2 * v + 1], ao_[v]);
    EXPECT_EQ(added[2 * v], 0.0f);
    EXPECT_EQ(added[2 * v + 1], ao_[v]);
  }
}

TEST_F(BakedChannel, ColoursAboveOneStayFloats) {
  write("in.glb", shaded_triangle({4, 1, 0.5f, 1}).glb());
  const std::vector<float> rgba = baked("", "COLOR_0", 4);
  for (std::size_t v = 0; v < 3; ++v) EXPECT_FLOAT_EQ(rgba[4 * v], 4 * ao_[v]);
}

TEST_F(BakedChannel, FloatsKeepTheChannelsThatAreNotNamed) {
  write("in.glb", shaded_triangle({1e-6f, 1e-5f, 0.3f, 1}).glb());
  const std::vector<float> rgba = baked("--channel COLOR_0.b", "COLOR_0", 4);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(rgba[4 * v], 1e-6f);
    EXPECT_EQ(rgba[4 * v + 1], 1e-5f);
    EXPECT_FLOAT_EQ(rgba[4 * v + 2], 0.3f * ao_[v]);
  }
}

TEST_F(BakedChannel, AoIsMultipliedWithTheColoursThatAreNamedOrReplacesThem) {
  struct Case {
    const char* options;
    std::array<bool, 4> named;
    bool multiplied;
  };
  for (const Case& c :
       {Case{"--blend multiply", {true, true, true, false}, true},
        Case{"--blend replace", {true, true, true, false}, false},
        Case{"--channel COLOR_0.g", {false, true, false, false}, true},
        Case{"--channel COLOR_0.b --blend replace", {false, false, true, false}, false},
        Case{"--channel COLOR_0.a", {false, false, false, true}, true}}) {
    const std::vector<float> rgba = baked(c.options, "COLOR_0", 4);
    for (std::size_t v = 0; v < 3; ++v) {
      ASSERT_LT(ao_[v], 0.8f);
      for (std::size_t k = 0; k < 4; ++k) {
        const float changed = c.multiplied ? kColor[k] * ao_[v] : ao_[v];
        EXPECT_NEAR(rgba[4 * v + k], c.named[k] ? changed : kColor[k], 1e-5)  // 16 bits
            << c.options << ", vertex " << v << ", component " << k;
      }
    }
  }
}

TEST_F(BakeCommand, TextFilesKeepTheirSideFilesAndBinaryOnesEmbedThem) {
  GltfBuilder builder = rich_triangle();
  json doc = builder.doc;
  doc["buffers"] = {{{"byteLength", builder.bin.size()},
                     {"uri", "mesh.bin"},
                     {"name", "shapes"},
                     {"extras", {{"year", 1905}}}}};
  write("mesh.bin", builder.bin);
  std::ofstream(path("in.gltf")) << doc.dump();
  ASSERT_EQ(dapple("bake in.gltf -o out.gltf").code, 0);
  const json text = document("out.gltf");
  EXPECT_EQ(text["buffers"][0]["uri"], "mesh.bin");
  EXPECT_EQ(text["buffers"][1]["uri"], "out_baked.bin");
  EXPECT_EQ(load_gltf(path("out.gltf")).meshes.size(), 1u);
  std::filesystem::create_directory(path("other"));
  ASSERT_EQ(dapple("bake in.gltf -o other/out.gltf").code, 0);
  EXPECT_EQ(bytes_of(path("other/mesh.bin")), bytes_of(path("mesh.bin")));
  EXPECT_EQ(load_gltf(path("other/out.gltf")).meshes.size(), 1u);
  ASSERT_EQ(dapple("bake in.gltf -o other/out.glb").code, 0);
  const json embedded = document("other/out.glb")["buffers"];
  ASSERT_EQ(embedded.size(), 1u);
  EXPECT_EQ(embedded[0]["name"], "shapes");
  EXPECT_EQ(embedded[0]["extras"]["year"], 1905);
  EXPECT_FALSE(embedded[0].contains("uri"));
  EXPECT_EQ(load_gltf(path("other/out.glb")).meshes.size(), 1u);
}

TEST_F(BakeCommand, ATextFileThatNeedsNoMoreDataGetsNoBuffer) {
  GltfBuilder builder = rich_triangle();
  builder.doc["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      builder.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, test::kFloat, "VEC2");
  json doc = builder.doc;
  doc["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", "mesh.bin"}}};
  write("mesh.bin", builder.bin);
  std::ofstream(path("in.gltf")) << doc.dump();
  const Outcome run = dapple("bake in.gltf -o out.gltf --to texture --size 16");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(document("out.gltf")["buffers"].size(), 1u);
  EXPECT_FALSE(std::filesystem::exists(path("out_baked.bin")));
  EXPECT_EQ(load_gltf(path("out.gltf")).meshes.size(), 1u);
}

TEST_F(BakeCommand, BentNormalsAreUnitVectorsAlsoWhereNoTriangleIs) {
  ASSERT_EQ(dapple("bake 'scene:tree?leaves=100' -o out.glb --passes ao,bent --rays 16").code, 0);
  const test::GltfData file(path("out.glb"));
  std::size_t found = 0;
  for (const json& primitive : file.doc["meshes"][0]["primitives"]) {
    const json& bent = primitive["attributes"]["_BENT_NORMAL"];
    test::expect_unit_vectors(file, bent);
    found += file.accessor(bent)["count"].get<std::size_t>();
  }
  EXPECT_GT(found, 100u);
}

TEST_F(BakeCommand, ATextureIsInAMaterialOfItsOwnAndTheMeshKeepsItsShape) {
  GltfBuilder builder = rich_triangle();
  builder.doc["materials"] = {{{"name", "leaf"}, {"doubleSided", true}}};
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to texture --size 16 --passes ao,bent");
  ASSERT_EQ(run.code, 0) << run.err;
  const json after = document("out.glb");
  const json& primitive = after["meshes"][0]["primitives"][0];
  const json& material = after["materials"][primitive["material"].get<std::size_t>()];
  EXPECT_EQ(material["name"], "leaf");
  EXPECT_EQ(material["occlusionTexture"]["texCoord"], 0);
  EXPECT_EQ(after["images"][0]["mimeType"], "image/png");
  EXPECT_EQ(after["accessors"][primitive["attributes"]["TEXCOORD_0"].get<std::size_t>()]["count"],
            3);
  const json& temperature =
      after["accessors"][primitive["attributes"]["_TEMPERATURE"].get<std::size_t>()];
  EXPECT_EQ(temperature["count"], 3) << "unknown attributes follow their vertices";
  const Scene before = load_gltf(path("in.glb")), scene = load_gltf(path("out.glb"));
  ASSERT_EQ(scene.meshes.at(0).indices.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(scene.meshes[0].positions[scene.meshes[0].indices[i]],
              before.meshes[0].positions[before.meshes[0].indices[i]]);
  EXPECT_TRUE(std::filesystem::exists(path("out_baked.exr")));
  // The texture's own coordinates can be used again.
  const Outcome again = dapple("bake out.glb -o again.gltf --to texture --size 16");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.err.find("TEXCOORD_0"), std::string::npos) << again.err;
  EXPECT_TRUE(std::filesystem::exists(path("again_ao.png")));
  EXPECT_EQ(document("again.gltf")["images"].back()["uri"], "again_ao.png");
}

TEST_F(BakeCommand, AProceduralSceneLeavesFilesBesideTheOutputAlone) {
  write("in.glb", rich_triangle().glb());
  std::filesystem::rename(path("in.glb"), path("out.glb.scene.glb"));
  const std::string before = bytes_of(path("out.glb.scene.glb"));
  const Outcome run = dapple("bake scene:cube -o out.glb");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(bytes_of(path("out.glb.scene.glb")), before);
  expect_failure(dapple("bake scene:nothing -o out.glb"), 2, "nothing");
  EXPECT_EQ(files_in_folder(), 2u) << "nothing else is left";
}

TEST_F(BakeCommand, AProceduralSceneIsBakedAndItsStatisticsAreWritten) {
  const Outcome run =
      dapple("bake 'scene:tree?leaves=500' -o out.glb --rays 16 --stats-json s.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const json statistics = document("s.json");
  EXPECT_GT(statistics["rays"].get<double>(), 0);
  EXPECT_GT(statistics["vertices"].get<double>(), 0);
  double passes = 0;
  for (const auto& [pass, seconds] : statistics["pass_seconds"].items())
    passes += seconds.get<double>();
  EXPECT_GT(statistics["pass_seconds"]["occlusion"], 0);
  EXPECT_LE(passes, statistics["seconds"]["trace"]);
  EXPECT_EQ(files_in_folder(), 2u) << "nothing else is left";
}

TEST_F(BakeCommand, ABakeGoesOnFromItsCheckpoint) {
  const std::string bake = "bake 'scene:tree?leaves=200' --rays 64 ";
  ASSERT_EQ(dapple(bake + "-o a.glb --checkpoint c.ckpt --checkpoint-every 1s -q").code, 0);
  const Outcome resumed = dapple(bake + "-o b.glb --resume c.ckpt");
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_NE(resumed.err.find("went on from c.ckpt"), std::string::npos) << resumed.err;
  EXPECT_EQ(bytes_of(path("a.glb")), bytes_of(path("b.glb")));
  expect_failure(dapple(bake + "-o c.glb --seed 3 --resume c.ckpt"), 2, "--seed");
  expect_failure(dapple(bake + "-o c.ckpt.glb --resume none.ckpt"), 3,
                 "--resume none.ckpt: there is no such file");
  expect_failure(dapple(bake + "-o c.glb --checkpoint c.glb"), 2, "--checkpoint");
  EXPECT_EQ(files_in_folder(), 3u);
}

TEST_F(BakeCommand, ErrorsSayWhatCanBeDoneAndLeaveNothingBehind) {
  write("in.glb", rich_triangle().glb());
  const std::pair<const char*, const char*> cases[] = {
      {"in.glb -o out.glb --channel NORMAL", "COLOR_0.rgb"},
      {"in.glb -o out.glb --rays 3", "--rays"},
      {"in.glb -o out.glb --sides top", "--sides"},
      {"in.glb -o out.glb --normals smooth", "--normals"},
      {"in.glb -o out.glb --to light", "--to"},
      {"in.glb -o out.glb --to texture --size 0", "--size"},
      {"in.glb -o out.glb --to texture --at vertices", "--at needs --to vertex"},
      {"in.glb -o out.glb --to texture --channel _AO", "--channel needs --to vertex"},
      {"in.glb -o out.glb --margin 4", "--margin needs --to texture"},
      {"in.glb -o out.glb --bent-channel NORMAL", "--bent-channel needs --passes ao,bent"},
      {"in.glb -o out.glb --light-rays 4", "--light-rays needs --passes ao,light"},
      {"in.glb -o out.glb --to instance --passes ao,bent", "--passes bent"},
      {"in.glb -o out.glb --to instance --instances alone", "--instances needs --to vertex or"},
      {"in.glb -o out.obj", ".gltf"},
      {"in.glb -o in.glb", "in.glb"},
      {"head.hair -o out.glb", "strands"},
  };
  for (const auto& [arguments, part] : cases) {
    const Outcome run = dapple(std::string("bake ") + arguments);
    expect_failure(run, 2, part);
    EXPECT_EQ(files_in_folder(), 1u) << arguments;
  }
  expect_failure(dapple("bake missing.glb -o out.glb"), 3, "missing.glb");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(BakeCommand, NoFileThatIsReadIsOverwritten) {
  write("in.glb", rich_triangle().glb());
  write("wall.glb", rich_triangle().glb());
  std::ofstream(path("sun.json"))
      << R"({"lights": [{"type": "sun", "name": "noon", "direction": [0, 0, -1]}]})";
  const std::string lit = "bake in.glb --passes ao,light --lights sun.json ";
  expect_failure(dapple(lit + "-o wall.glb --occluders wall.glb"), 2, "would overwrite wall.glb");
  expect_failure(dapple(lit + "-o out.glb --stats-json sun.json"), 2, "would overwrite sun.json");
  EXPECT_EQ(files_in_folder(), 3u);
}

TEST_F(BakeCommand, ANoteSaysThatAlphaIsOpacity) {
  write("in.glb", rich_triangle().glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel COLOR_0.a");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find("COLOR_0.a is opacity"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace dapple
