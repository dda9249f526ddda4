// Outputs of the program that would fail or destroy an input: refused with the name of the option,
// before any work, with no files left behind.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

using program_test::Outcome;

class OutputFiles : public program_test::ProgramRun {};

TEST_F(OutputFiles, AnOutputThatCannotBeWrittenIsFoundBeforeTheSceneIsRead) {
  std::filesystem::create_directory(path("folder"));
  for (const char* output : {"missing/out.exr", "folder", "folder/x/out.exr"}) {
    // The scene is missing too, which would be code 3. Code 2 shows that the output is checked
    // first.
    expect_failure(dapple(std::string("render nosuch.glb -o ") + output), 2, output);
    expect_failure(dapple(std::string("render nosuch.glb -o a.exr --png ") + output), 2, output);
    expect_failure(dapple(std::string("render nosuch.glb -o a.exr --stats-json ") + output), 2,
                   output);
    expect_failure(dapple(std::string("scene tree -o ") + output), 2, output);
  }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(OutputFiles, AnOutputThatIsAnInputByAnyLinkIsRefusedByItsFlag) {
  ASSERT_EQ(dapple("scene cube -o scene.glb").code, 0);
  write_bytes(path("lights.json"), "{\"lights\": []}");
  std::filesystem::create_symlink("scene.glb", path("soft.exr"));
  std::filesystem::create_hard_link(path("scene.glb"), path("hard.exr"));
  std::filesystem::create_symlink("lights.json", path("lights.exr"));
  const std::string before = bytes_of(path("scene.glb"));
  const std::string render = "render scene.glb --lights lights.json -o ";
  for (const char* output : {"scene.glb", "./scene.glb", "soft.exr", "hard.exr"}) {
    expect_failure(dapple(render + output), 2, "--output");
    expect_failure(dapple(render + "a.exr --png " + output), 2, "--png");
    expect_failure(dapple(render + "a.exr --stats-json " + output), 2, "--stats-json");
  }
  expect_failure(dapple(render + "lights.json"), 2, "--output");
  expect_failure(dapple(render + "lights.exr"), 2, "--output");
  EXPECT_EQ(bytes_of(path("scene.glb")), before);
  EXPECT_EQ(files_in_folder(), 5u);
}

TEST_F(OutputFiles, AnOutputThatIsTheImageOfADomeInALightsFileIsRefused) {
  EXPECT_EQ(render("").code, 0);
  const std::string before = bytes_of(path("out.exr"));
  write_bytes(path("sky.json"), R"({"lights": [{"type": "dome", "image": "out.exr"}]})");
  expect_failure(render("--lights sky.json"), 2, "would overwrite");
  EXPECT_EQ(bytes_of(path("out.exr")), before);
}

TEST_F(OutputFiles, AnOutputThatIsABufferOrImageOfTheSceneIsRefusedByItsFlag) {
  write_bytes(path("a.bin"), std::string(36, '\0'));
  write_bytes(path("scene.gltf"), R"({"asset": {"version": "2.0"},
    "buffers": [{"uri": "a.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
    "images": [{"uri": "leaf.png"}]})");
  expect_failure(dapple("render scene.gltf -o a.bin"), 2, "--output a.bin: would overwrite");
  expect_failure(dapple("render scene.gltf -o a.exr --png leaf.png"), 2, "--png leaf.png");
  EXPECT_EQ(bytes_of(path("a.bin")), std::string(36, '\0'));
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(OutputFiles, OutputsThatAreOneFileAreRefusedByTheirFlags) {
  std::filesystem::create_directory(path("folder"));
  std::filesystem::create_symlink("folder", path("link"));
  write_bytes(path("old.exr"), "old");
  std::filesystem::create_hard_link(path("old.exr"), path("same.exr"));
  expect_failure(render("--png out.exr"), 2, "--png is out.exr, but previews are PNG files");
  expect_failure(render("--png out.JPG"), 2, "--png is out.JPG, but previews are PNG files");
  std::filesystem::create_symlink("out.exr", path("out.png"));
  expect_failure(render("--png ./out.png"), 2, "--png");
  std::filesystem::remove(path("out.png"));
  expect_failure(render("--png a.png --stats-json a.png"), 2, "--stats-json");
  expect_failure(render("--png folder/a.png --stats-json link/a.png"), 2, "--stats-json");
  expect_failure(render("--deep old.exr --stats-json same.exr"), 2, "--stats-json");
  expect_failure(render("--passes ao,visits --png a.png --stats-json a_visits.png"), 2,
                 "--stats-json");
  expect_failure(dapple("compare old.exr same.exr --png same.exr"), 2, "--png");
  EXPECT_EQ(files_in_folder(), 4u);
}

TEST_F(OutputFiles, AnOutputThatIsNoRegularFileIsRefusedByItsFlag) {
  std::filesystem::create_symlink("nowhere", path("dangling.exr"));
  std::filesystem::create_symlink("loop.exr", path("loop.exr"));
  ASSERT_EQ(std::system(("mkfifo '" + path("fifo.exr") + "'").c_str()), 0);
  for (const char* output : {"/dev/null", "/dev/full", "fifo.exr", "dangling.exr", "loop.exr"}) {
    expect_failure(dapple(std::string("render scene:cube -o ") + output), 2, "--output");
    expect_failure(render(std::string("--png ") + output), 2, "--png");
  }
  EXPECT_EQ(files_in_folder(), 3u);
}

TEST_F(OutputFiles, AFailedWriteExitsWith1AndLeavesNothingBehind) {
  // A limit of one block for each file simulates a full disk; the message still fits.
  const Outcome run = dapple("scene cube -o x.glb", "trap '' XFSZ && ulimit -f 1 &&");
  expect_failure(run, 1, "x.glb");
  EXPECT_EQ(files_in_folder(), 0u);
}

// The EXR has more than 2.1 MB, which is the least that PoCL needs; the other files have less.
TEST_F(OutputFiles, ABakeWhoseLastFileFailsLeavesTheOldOnes) {
  ASSERT_EQ(dapple("scene cube -o in.glb").code, 0);
  const std::string bake =
      "bake in.glb -o out.gltf --to texture --size 1024 --passes ao,bent --png out.png --rays 8";
  ASSERT_EQ(dapple(bake).code, 0);
  const auto contents = [&] {
    std::vector<std::size_t> hashes;
    for (const char* name : {"out.gltf", "out.bin", "out_ao.png", "out_baked.exr", "out.png"})
      hashes.push_back(std::hash<std::string>()(bytes_of(path(name))));
    return hashes;
  };
  const std::vector<std::size_t> before = contents();
  expect_failure(dapple(bake + " --seed 1", "trap '' XFSZ && ulimit -f 4200 &&"), 1,
                 "out_baked.exr");
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(files_in_folder(), 6u);
  EXPECT_EQ(dapple(bake + " --seed 1").code, 0);
  EXPECT_NE(contents(), before) << "another seed makes others";
}

// Buffer and texture of a .gltf have names that no option says.
TEST_F(OutputFiles, AFileBesideAGltfThatAnotherOptionNamesIsRefused) {
  ASSERT_EQ(dapple("scene cube -o in.glb").code, 0);
  const std::string bake = "bake in.glb -o out.gltf --to texture --size 16 --rays 8";
  expect_failure(dapple(bake + " --png out_ao.png"), 2, "is the same file as --png");
  expect_failure(dapple(bake + " --stats-json ./out.bin"), 2, "is the same file as --stats-json");
  std::filesystem::create_directory(path("out.bin"));
  expect_failure(dapple(bake), 2, "out.bin");
  EXPECT_EQ(files_in_folder(), 2u);
}

}  // namespace
}  // namespace dapple
