// Files beside the output of dapple bake: those of another asset are not replaced, and those that
// extensions name go to the output's folder, too.
#include <gtest/gtest.h>

#include <set>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;
namespace fs = std::filesystem;

class BakeSideFiles : public BakeCommand {
 protected:
  BakeSideFiles() {
    for (const char* folder : {"in", "out"}) fs::create_directory(path(folder));
  }

  /// in/tree.gltf with in/tree.bin.
  void write_tree(const GltfBuilder& builder) const {
    json doc = builder.doc;
    doc["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", "tree.bin"}}};
    write("in/tree.bin", builder.bin);
    std::ofstream(path("in/tree.gltf")) << doc.dump();
  }

  /// Paths of the files below out/.
  [[nodiscard]] std::set<std::string> written() const {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(path("out")))
      if (entry.is_regular_file())
        files.insert(entry.path().lexically_relative(path("out")).generic_string());
    return files;
  }
};

TEST_F(BakeSideFiles, OfAnotherAssetAreNotReplacedAndThoseOfAnEarlierBakeAre) {
  write_tree(rich_triangle());
  const std::string bake =
      "bake in/tree.gltf -o out/tree.gltf --to texture --size 16 --uv own --rays 8";
  for (const std::string foreign : {"tree_ao.png", "tree_baked.bin"}) {
    SCOPED_TRACE(foreign);
    write_bytes(path("out/" + foreign), "of another asset");
    expect_failure(dapple(bake), 2, "out/" + foreign + " is written beside it");
    EXPECT_EQ(written(), std::set{foreign});
    EXPECT_EQ(bytes_of(path("out/" + foreign)), "of another asset");
    fs::remove(path("out/" + foreign));
  }
  std::set<std::string> first;
  for (const int time : {1, 2}) {
    SCOPED_TRACE(time);
    const Outcome run = dapple(bake);
    ASSERT_EQ(run.code, 0) << run.err;
    if (time == 1) first = written();
    EXPECT_EQ(written(), first);
  }
  for (const char* file : {"tree.gltf", "tree.bin", "tree_ao.png", "tree_baked.bin"})
    EXPECT_TRUE(first.contains(file)) << file;
}

// An earlier output is there, which does not name them.
TEST_F(BakeSideFiles, OfAnotherAssetAreNotReplacedBesideAnOlderOutput) {
  write_tree(rich_triangle());
  const std::string bake =
      "bake in/tree.gltf -o out/tree.gltf --to texture --size 16 --uv own --rays 8 "
      "--passes ao,bent -q";
  const std::string older = R"({"asset": {"version": "2.0"}})";
  write_bytes(path("out/tree.gltf"), older);
  for (const std::string foreign : {"tree_ao.png", "tree_baked.bin", "tree_baked.exr"}) {
    SCOPED_TRACE(foreign);
    write_bytes(path("out/" + foreign), "of another asset");
    expect_failure(dapple(bake), 2, "out/" + foreign + " is written beside it");
    EXPECT_EQ(bytes_of(path("out/" + foreign)), "of another asset");
    EXPECT_EQ(bytes_of(path("out/tree.gltf")), older);
    fs::remove(path("out/" + foreign));
  }
}

TEST_F(BakeSideFiles, ThePictureOfARenderIsNotReplacedAndTheExrOfABakeIs) {
  write_tree(rich_triangle());
  const std::string bake =
      "bake in/tree.gltf -o out/tree.glb --to texture --size 16 --rays 8 --passes ao,bent -q";
  ASSERT_EQ(dapple("render in/tree.gltf -o out/tree_baked.exr --width 8 --height 8 -q").code, 0);
  const Outcome refused = dapple(bake);
  expect_failure(refused, 2, "out/tree_baked.exr is written beside it");
  EXPECT_EQ(refused.err.find("or a .glb"), std::string::npos) << refused.err;
  fs::remove(path("out/tree_baked.exr"));
  for (const int time : {1, 2}) EXPECT_EQ(dapple(bake).code, 0) << time;
}

/// A triangle with files that extensions name, and strings that are no such names.
GltfBuilder triangle_with_sounds() {
  GltfBuilder builder = rich_triangle();
  json& audio = builder.doc["extensions"]["KHR_audio"];
  audio["audio"] = {{{"uri", "wind.mp3"}},
                    {{"uri", "sounds/far%20rain.mp3"}},
                    {{"uri", "data:audio/mpeg;base64,AAAA"}},
                    {{"uri", "http://localhost/wind.mp3"}},
                    {{"uri", "absent.mp3"}}};
  audio["extras"] = {{"uri", "notes.txt"}};
  builder.doc["extensions"]["EXT_structural_metadata"] = {{"schemaUri", "schema.json"}};
  builder.doc["extras"] = {{"uri", "notes.txt"},
                           {"extensions", {{"KHR_audio", {{"uri", "notes.txt"}}}}}};
  for (const char* name : {"KHR_audio", "EXT_structural_metadata"})
    builder.doc["extensionsUsed"].push_back(name);
  return builder;
}

// A texture, then vertices: each output names other files than the one before.
TEST_F(BakeSideFiles, OfEarlierBakesOfAnotherKindAreInNoBakesWay) {
  write_tree(rich_triangle());
  for (const char* to :
       {"", "--to texture --size 16", "--to texture --size 16", "", "--channel _AO"})
    EXPECT_EQ(dapple(std::string("bake in/tree.gltf -o out/tree.gltf --rays 8 -q ") + to).code, 0)
        << to;
}

TEST_F(BakeSideFiles, ThatExtensionsNameOutsideOfTheFolderAreLeftAlone) {
  for (const char* uri : {"../wind.mp3", "/schemas/a.json"}) {
    GltfBuilder builder = rich_triangle();
    builder.doc["extensions"]["ACME_wind"]["uri"] = uri;
    write_tree(builder);
    write_bytes(path("wind.mp3"), "wind");
    EXPECT_EQ(dapple("bake in/tree.gltf -o out/tree.glb --rays 8 -q").code, 0) << uri;
    EXPECT_EQ(written(), std::set<std::string>{"tree.glb"});
  }
}

TEST_F(BakeSideFiles, ThatExtensionsNameAreReplacedByThoseOfTheNextBake) {
  GltfBuilder builder = rich_triangle();
  builder.doc["extensions"]["ACME_wind"]["schemaUri"] = "schema.json";
  write_tree(builder);
  for (const char* schema : {"1", "2"}) {
    write_bytes(path("in/schema.json"), schema);
    for (const char* output : {"out/a.glb", "out/b.gltf"}) {
      // Each in a folder of its own.
      const std::string folder = std::string(output) + ".d/";
      fs::create_directories(path(folder));
      const Outcome run = dapple("bake in/tree.gltf -o " + folder +
                                 fs::path(output).filename().string() + " --rays 8 -q");
      EXPECT_EQ(run.code, 0) << run.err;
      EXPECT_EQ(bytes_of(path(folder + "schema.json")), schema);
    }
  }
}

TEST_F(BakeSideFiles, ThatExtensionsNameAreCopiedAndThoseOfExtrasAreNot) {
  write_tree(triangle_with_sounds());
  const std::set<std::string> named = {"wind.mp3", "sounds/far rain.mp3", "schema.json"};
  for (const std::string& file : named) write_bytes(path("in/" + file), "content of " + file);
  write_bytes(path("in/notes.txt"), "of nobody else");
  for (const auto& [output, others] : std::map<std::string, std::set<std::string>>{
           {"tree.gltf", {"tree.gltf", "tree.bin", "tree_baked.bin"}},
           {"tree.glb", {"tree.glb"}}}) {
    SCOPED_TRACE(output);
    const Outcome run = dapple("bake in/tree.gltf --rays 8 -o out/" + output);
    ASSERT_EQ(run.code, 0) << run.err;
    std::set<std::string> expected = named;
    expected.insert(others.begin(), others.end());
    EXPECT_EQ(written(), expected);
    for (const std::string& file : named)
      EXPECT_EQ(bytes_of(path("out/" + file)), "content of " + file);
    for (const char* key : {"extensions", "extras"})
      EXPECT_EQ(document("out/" + output)[key], document("in/tree.gltf")[key]);
    fs::remove_all(path("out"));
    fs::create_directory(path("out"));
  }
}

}  // namespace
}  // namespace dapple
