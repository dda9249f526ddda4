// dapple bake where the output cannot be written, and of meshes that lack what others have:
// normals, texture coordinates that can be used, area, room in the texture.
#include <gtest/gtest.h>

#include "dapple/scene.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class BakeBadInput : public BakeCommand {
 protected:
  /// One mesh of a primitive with these vertices and attributes beside them, without indices.
  void write_mesh(const std::string& name, const std::vector<float>& positions,
                  const std::vector<float>& uvs = {},
                  const std::vector<float>& normals = {}) const {
    GltfBuilder builder;
    json attributes = {{"POSITION", builder.add_positions(positions)}};
    if (!uvs.empty()) attributes["TEXCOORD_0"] = builder.add_accessor(uvs, test::kFloat, "VEC2");
    if (!normals.empty())
      attributes["NORMAL"] = builder.add_accessor(normals, test::kFloat, "VEC3");
    builder.add_mesh({{"attributes", attributes}});
    write(name, builder.glb());
  }
  /// A triangle whose data are in a file beside it.
  void write_text_file(const std::string& name, const std::string& buffer) const {
    GltfBuilder builder;
    builder.add_triangle();
    builder.doc["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", buffer}}};
    write_bytes(path(buffer), {builder.bin.begin(), builder.bin.end()});
    std::ofstream(path(name)) << builder.doc.dump();
  }
  [[nodiscard]] std::vector<float> ao_of(const std::string& name) const {
    const test::GltfData file(path(name));
    return file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["_AO"]);
  }
};

const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// `count` triangles of area 1/2 above each other.
std::vector<float> stack_of(int count) {
  std::vector<float> positions;
  for (int i = 0; i < count; ++i) {
    const float z = static_cast<float>(i);
    positions.insert(positions.end(), {0, 0, z, 1, 0, z, 0, 1, z});
  }
  return positions;
}

TEST_F(BakeBadInput, AFolderThatIsMissingIsFoundBeforeTheSceneIsRead) {
  // The scene is missing too, which would be code 3.
  for (const char* outputs :
       {"-o missing/o.glb", "-o missing/o.gltf --to texture", "-o o.glb --png missing/o.png",
        "-o o.glb --stats-json missing/s.json", "-o o.glb --checkpoint missing/c.ckpt"}) {
    const Outcome run = dapple(std::string("bake nosuch.glb ") + outputs);
    expect_failure(run, 2, "there is no folder missing");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(BakeBadInput, AReadOnlyFolderIsFoundBeforeTheSceneIsRead) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  std::filesystem::create_directory(path("folder"));
  const std::string mount = in_namespace("mount -t tmpfs -o ro none folder");
  expect_failure(dapple("bake nosuch.glb -o folder/o.glb", mount), 2,
                 "--output: cannot write folder/o.glb: folder folder: Read-only file system");
  expect_failure(dapple("bake 'scene:tree?leaves=10' -o folder/o.gltf", mount), 2, "Read-only");
}

// On file systems of so few pages that, beside the old files, there is room for some of the new
// ones.
TEST_F(BakeBadInput, AFullDiskLeavesTheFilesOfAnEarlierBakeAsTheyWere) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  write_mesh("in.glb", stack_of(40));
  std::filesystem::create_directory(path("disk"));
  const std::string old = R"({"buffers": [{"uri": "out.bin"}], "images": [{"uri": "out_ao.png"}]})";
  write_bytes(path("old/out.gltf"), old);
  for (const char* name : {"out.bin", "out_ao.png"})
    write_bytes(path(std::string("old/") + name), std::string("old ") + name);
  for (const auto& [size, first_failure] : {std::pair{"16k", "out.bin"}, {"20k", "out.gltf"}}) {
    const std::string mount = std::string("mount -t tmpfs -o size=") + size + " none disk";
    const std::string run_and_list =
        " sh -c 'cp old/* disk; \"$0\" \"$@\"; code=$?; cat disk/* >found; LC_ALL=C ls -A disk "
        ">>found; "
        "exit $code'";
    const Outcome run = dapple("bake in.glb -o disk/out.gltf --to texture --size 64 --rays 8 -q",
                               in_namespace(mount) + run_and_list);
    expect_failure(run, 1,
                   std::string("cannot write disk/") + first_failure + ": No space left on device");
    EXPECT_TRUE(bytes_of(path("found")) ==
                "old out.bin" + old + "old out_ao.pngout.bin\nout.gltf\nout_ao.png\n")
        << size;
  }
  std::filesystem::remove_all(path("old"));
}

TEST_F(BakeBadInput, ATextFileThatWasBakedIsBakedAgainIntoFilesWithOtherNames) {
  write_mesh("in.glb", kTriangle);
  const std::string texture = " --to texture --size 16";
  ASSERT_EQ(dapple("bake in.glb -o first.gltf --channel _AO").code, 0);
  ASSERT_EQ(dapple("bake first.gltf -o out.gltf --channel _MORE").code, 0);
  std::filesystem::create_directory(path("other"));
  ASSERT_EQ(dapple("bake out.gltf -o other/out.gltf --channel _MOST").code, 0);
  const json buffers = document("other/out.gltf")["buffers"];
  EXPECT_EQ(buffers[1]["uri"], "out_baked.bin");
  EXPECT_EQ(buffers[2]["uri"], "out_baked_2.bin");
  EXPECT_TRUE(bytes_of(path("other/out_baked.bin")) == bytes_of(path("out_baked.bin")));
  ASSERT_EQ(dapple("bake out.gltf -o picture.gltf" + texture).code, 0);
  ASSERT_EQ(dapple("bake picture.gltf -o other/picture.gltf" + texture).code, 0);
  EXPECT_EQ(document("other/picture.gltf")["images"][1]["uri"], "picture_ao_2.png");
  EXPECT_TRUE(bytes_of(path("other/picture_ao.png")) == bytes_of(path("picture_ao.png")));
}

TEST_F(BakeBadInput, CopiesOfSideFilesReplaceNoOtherFiles) {
  write_text_file("in.gltf", "in.bin");
  write_bytes(path("other/in.bin"), "another's");
  expect_failure(dapple("bake in.gltf -o other/out.gltf"), 2,
                 "--output other/out.gltf: in.bin is copied beside it, but other/in.bin is another "
                 "file of that name; write to another folder, or a .glb, which embeds all");
  EXPECT_TRUE(bytes_of(path("other/in.bin")) == "another's");
  EXPECT_FALSE(std::filesystem::exists(path("other/out.gltf")));
  EXPECT_EQ(dapple("bake in.gltf -o other/out.glb").code, 0);
  write_bytes(path("other/in.bin"), bytes_of(path("in.bin")));
  EXPECT_EQ(dapple("bake in.gltf -o other/out.gltf").code, 0) << "the same content";
  write_bytes(path("in.bin"), bytes_of(path("in.bin")) + "more");
  EXPECT_EQ(dapple("bake in.gltf -o other/out.gltf").code, 0) << "the output's own copy";
  EXPECT_TRUE(bytes_of(path("other/in.bin")) == bytes_of(path("in.bin")));
}

TEST_F(BakeBadInput, AFileThatTwoBuffersNameIsCopied) {
  write_text_file("in.gltf", "in.bin");
  json twice = document("in.gltf");
  twice["buffers"].push_back(twice["buffers"][0]);
  write_bytes(path("in.gltf"), twice.dump());
  std::filesystem::create_directory(path("other"));
  EXPECT_EQ(dapple("bake in.gltf -o other/out.gltf --png other/out.png").code, 0);
  EXPECT_TRUE(bytes_of(path("other/in.bin")) == bytes_of(path("in.bin")));
}

TEST_F(BakeBadInput, AFileInTheWayOfAFolderForCopiesIsFoundBeforeAnyWork) {
  write_text_file("in.gltf", "data/in.bin");
  write_bytes(path("other/data"), "a file");
  expect_failure(dapple("bake in.gltf -o other/out.gltf"), 2, "other/data is not a folder");
  std::filesystem::remove(path("other/data"));
  std::filesystem::create_directories(path("other/data/in.bin"));
  expect_failure(dapple("bake in.gltf -o other/out.gltf"), 2, "it is a folder");
  EXPECT_FALSE(std::filesystem::exists(path("other/out.gltf")));
  write_text_file("plain.gltf", "in.bin");
  std::filesystem::create_directories(path("here/in.bin"));
  expect_failure(dapple("bake ../plain.gltf -o out.gltf", "cd here &&"), 2, "it is a folder");
}

// Points of a palette, for one: no texel was covered, and AO was 1 everywhere.
TEST_F(BakeBadInput, CoordinatesWithoutAreaAreSaidWithTheirShareAndReplaced) {
  const std::string reason = "TEXCOORD_0 has no area in the texture for ";
  const std::string replaced =
      " % of the surface: the texture has coordinates of its own, TEXCOORD_1\n";
  for (const auto& [second, share] :
       {std::pair{std::vector<float>{0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, "50.0"},
        {std::vector<float>{0.6f, 0.9f, 0.7f, 0.9f, 0.8f, 0.9f}, "50.0"}}) {
    std::vector<float> uvs = {0, 0, 0.4f, 0, 0, 0.4f};
    uvs.insert(uvs.end(), second.begin(), second.end());
    write_mesh("in.glb", stack_of(2), uvs);
    const Outcome run = dapple("bake in.glb -o out.glb --to texture --size 64");
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_TRUE(contains(run.err, reason + share + replaced)) << run.err;
  }
}

TEST_F(BakeBadInput, CoordinatesThatOverlapAreSaidWithTheirShareAndReplaced) {
  const std::vector<float> full = {0, 0, 1, 0, 0, 1}, left = {0, 0, 0.5f, 0, 0, 0.5f},
                           outside = {0, 0, 2, 0, 0, 1};
  const auto bake_with = [&](const std::vector<float>& first, const std::vector<float>& second) {
    std::vector<float> uvs = first;
    uvs.insert(uvs.end(), second.begin(), second.end());
    write_mesh("in.glb", stack_of(2), uvs);
    const Outcome run = dapple("bake in.glb -o out.glb --to texture --size 64");
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err;
  };
  const std::string replaced = ": the texture has coordinates of its own, TEXCOORD_1\n";
  EXPECT_TRUE(contains(bake_with(full, full),
                       "TEXCOORD_0 overlaps itself in 100.0 % of its texels" + replaced));
  // A quarter of the large triangle has the small one on it.
  const std::string quarter = bake_with(full, left);
  const std::size_t share = quarter.find(" in ");
  ASSERT_NE(share, std::string::npos) << quarter;
  EXPECT_NEAR(std::stod(quarter.substr(share + 4)), 25, 1) << quarter;
  EXPECT_TRUE(contains(bake_with(full, outside), "TEXCOORD_0 leaves the texture" + replaced));
  const json after = document("out.glb");
  const json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("TEXCOORD_0")) << "what other textures use is kept";
  EXPECT_TRUE(attributes.contains("TEXCOORD_1"));
  EXPECT_EQ(after["materials"][0]["occlusionTexture"]["texCoord"], 1);
}

TEST_F(BakeBadInput, MoreChartsThanTheTextureHasRoomForNeedTheSizeThatIsSaid) {
  write_mesh("in.glb", stack_of(40));
  const std::string bake = "bake in.glb -o out.glb --to texture --size ";
  const Outcome run = dapple(bake + "8");
  expect_failure(run, 2, "--size is 8; the 40 charts of this scene need at least ");
  EXPECT_EQ(files_in_folder(), 1u);
  const std::string least = run.err.substr(run.err.rfind(' ') + 1);
  EXPECT_EQ(dapple(bake + least.substr(0, least.size() - 1)).code, 0) << least;
}

TEST_F(BakeBadInput, AMeshWithoutNormalsHasTheValuesOfFlatOnes) {
  std::vector<float> up;
  for (int i = 0; i < 9; ++i) up.insert(up.end(), {0, 0, 1});
  write_mesh("bare.glb", stack_of(3));
  write_mesh("flat.glb", stack_of(3), {}, up);
  for (const std::string name : {"bare", "flat"})
    ASSERT_EQ(dapple("bake " + name + ".glb -o " + name + "_ao.glb --channel _AO").code, 0);
  EXPECT_EQ(bits_of(ao_of("bare_ao.glb")), bits_of(ao_of("flat_ao.glb")));
  EXPECT_LT(ao_of("bare_ao.glb")[0], 0.99f);
  const json after = document("bare_ao.glb");
  EXPECT_FALSE(after["meshes"][0]["primitives"][0]["attributes"].contains("NORMAL"));
}

TEST_F(BakeBadInput, TrianglesWithoutAreaAreCountedAndTheirVerticesAreUnoccluded) {
  std::vector<float> positions = stack_of(2);
  positions.insert(positions.end(), {0, 0, 0.5f, 0.5f, 0, 0.5f, 1, 0, 0.5f});
  write_mesh("in.glb", positions);
  for (const char* to : {"vertex --channel _AO", "texture --size 16", "instance"}) {
    const Outcome run = dapple(std::string("bake in.glb -o out.glb --to ") + to);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_TRUE(contains(run.err, "dropped 1 triangle without an area")) << run.err;
    if (to[0] != 'v') continue;
    const std::vector<float> ao = ao_of("out.glb");
    ASSERT_EQ(ao.size(), 9u);
    EXPECT_LT(ao[0], 0.99f);
    for (std::size_t v = 6; v < 9; ++v) EXPECT_EQ(ao[v], 1) << v;
  }
}

TEST_F(BakeBadInput, ANoteOfTheSceneIsSaidOnce) {
  GltfBuilder builder;
  builder.add_triangle();
  json points = builder.doc["meshes"][0]["primitives"][0];
  points["mode"] = 0;
  builder.doc["meshes"][0]["primitives"].push_back(points);
  write("in.glb", builder.glb());
  for (const char* options : {"", "--instances alone", "--instances unique", "--to instance"}) {
    const Outcome run = dapple(std::string("bake in.glb -o out.glb ") + options);
    ASSERT_EQ(run.code, 0) << run.err;
    const std::size_t note = run.err.find("point primitives are ignored");
    ASSERT_NE(note, std::string::npos) << options;
    EXPECT_EQ(note, run.err.rfind("point primitives are ignored")) << options << run.err;
  }
}

TEST_F(BakeBadInput, AFileOfNothingButTrianglesWithoutAreaIsRefused) {
  write_mesh("in.glb", {0, 0, 0, 1, 0, 0, 2, 0, 0});
  for (const char* to : {"vertex", "texture", "instance"}) {
    expect_failure(dapple(std::string("bake in.glb -o out.glb --to ") + to), 3,
                   "in.glb: there is nothing to render");
    EXPECT_EQ(files_in_folder(), 1u);
  }
}

}  // namespace
}  // namespace dapple
