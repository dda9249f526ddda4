// Good values of options: each command has runs that end well and that together have every option
// of its help, so that a new option needs a run here. The scenes are tiny.
#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"
#include "support/programs/command_help.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

const std::string kKernels = "--device - --kernel-dir '" DAPPLE_SOURCE_FOLDER "/kernels' ";

/// A triangle that climbs, a line, and a camera, each with a name.
test::GltfBuilder stage() {
  test::GltfBuilder b = test::one_triangle();
  b.add_mesh({{"mode", 1}, {"attributes", {{"POSITION", b.add_positions({0, 0, 0, 0, 1, 1})}}}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
  b.add("nodes", {{"translation", {0.3, 0.5, 4}}, {"camera", 0}, {"name", "side"}});
  b.add_movement(0, {0, 1}, {0, 0, 0, 0, 1, 0})["name"] = "climb";
  return b;
}

class GoodValues : public ProgramRun {
 protected:
  void SetUp() override {
    // A Radiance image of one white pixel.
    write_bytes(path("sky.hdr"),
                "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81");
    write_bytes(
        path("lights.json"),
        R"({"lights": [{"type": "dome", "name": "clouds", "image": "sky.hdr", "exposure": -1},
                       {"type": "disk", "name": "lamp", "position": [0, 3, 0], "target": [0, 0, 0],
                        "radius": 0.5, "radiance": [9, 9, 9]}]})");
    write("stage.glb", stage().glb());
  }

  /// Runs the program, which must end well and not call an option useless.
  void run(const std::string& arguments) {
    const Outcome result = dapple(arguments);
    EXPECT_EQ(result.code, 0) << arguments << "\n" << result.err;
    EXPECT_FALSE(contains(result.err, "changes nothing")) << arguments << "\n" << result.err;
    note_options(arguments);
  }

  /// Notes the options of a run, whose first word is the command.
  void note_options(const std::string& arguments) {
    std::istringstream words(arguments);
    std::string command;
    words >> command;
    for (std::string word; words >> word;)
      given_[command].insert(word == "-o"   ? "--output"
                             : word == "-q" ? "--quiet"
                                            : word.substr(0, word.find('=')));
  }

  void expect_all_options_given(const std::string& command) {
    const std::vector<Option> options = options_in(dapple(command + " --help").out);
    EXPECT_FALSE(options.empty());
    for (const Option& option : options)
      EXPECT_TRUE(given_[command].contains(option.flag))
          << command << " " << option.flag << ": no good run";
  }

  void expect_files(std::initializer_list<const char*> names) const {
    for (const char* name : names) EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
  }

 private:
  std::map<std::string, std::set<std::string>> given_;  ///< by command: options of its runs
};

TEST_F(GoodValues, AreTestedOfEveryCommand) {
  const std::set<std::string> tested{"render", "bake",  "points", "compare", "info",
                                     "scene",  "merge", "plan",   "devices"};
  EXPECT_EQ(commands_in(dapple("--help").out), tested);
}

/// Options of `dapple render` that `dapple plan` takes too.
const std::vector<std::string> kPictures = {
    "-o a.exr --exposure -1.5 --background 0.1,0.2,0.3 --png a.png --half ao,light.sun "
    "--compression piz --crop 2,1,9,7 --seed 7 --passes ao,light,albedo,beauty,back --back-every 4 "
    "--normals geometric --cryptomatte object,material --stats-json a.json -q",
    "-o b.exr --exposure auto --background none --png b.png --compression dwaa --multipart "
    "--half all --camera-splitting 2 --ao-rays 3 --light-rays 2 --footprint 2 --max-bias 0.05 "
    "--report-bias 50% --ambient 0.5 --normals shading --ao-distance 3 --ao-falloff 2 --ground "
    "--ground-height=-0.1",
    "-o c.exr --background sky --png c.png --look-from 0,1,6 --look-at 0,0.5,0 --up 0,1,0.1 "
    "--fov 30 --aperture 0.05 --focus-distance 6 --light-radius 0.2 --opacity leaf=0.5 "
    "--estimator exact --roulette 0.5 --packets none --cache trees " +
        kKernels,
    "-o g.dapple --shard 1/2 --dome sky.hdr --dome-rotation 90",
};

const std::string kPicture = " --width 16 --height 12 --spp 8 ";
const std::string kTree = " 'scene:tree?leaves=500&wind=1'" + kPicture;
const std::string kStage =
    " stage.glb --camera side --animation climb --line-radius 0.01 "
    "--allow-outside" +
    kPicture;
/// Of a picture whose state is saved.
const std::string kSaved = "--lights lights.json --target-error 0.2 --max-spp 32 ";

TEST_F(GoodValues, OfRenderMakeAPicture) {
  for (const std::string& options : kPictures) run("render" + kTree + options);
  run("render" + kTree + kSaved + "-o d.exr --checkpoint d.ckpt --checkpoint-every 5m");
  run("render" + kTree + kSaved + "-o h.exr --resume d.ckpt");
  run("render" + kTree + kSaved + "-o h.exr --resume-or-begin d.ckpt");
  run("render" + kTree +
      "-o 'f.#.exr' --frames 1-2 --animate-seed --fps 30 --passes ao,motion,visits "
      "--target-rmse 0.1");
  run("render" + kStage +
      "-o e.exr --deep e_deep.exr --frame 0.5 --fps 12 --shutter 0,0.5 "
      "--motion-samples 2");
  expect_all_options_given("render");
  expect_files({"a.exr", "a.png", "a.json", "b.exr", "b.png", "c.exr", "c.png", "d.exr", "d.ckpt",
                "e.exr", "e_deep.exr", "f.1.exr", "f.2.exr", "g.dapple", "h.exr"});
  const Film lit = read_exr(path("d.exr"));
  EXPECT_NE(lit.find("light.clouds.R"), nullptr);
  EXPECT_NE(lit.find("light.lamp.R"), nullptr);
}

TEST_F(GoodValues, OfPlanAreThoseOfRenderButForWhatItRefuses) {
  for (const std::string& options : kPictures) run("plan" + kTree + options);
  run("plan" + kTree +
      "--lights lights.json --checkpoint d.ckpt --checkpoint-every 5m "
      "--frames 1-2 --animate-seed --fps 30");
  run("plan" + kStage + "--frame 0.5");
  std::set<std::string> help;
  for (const Option& option : options_in(dapple("plan --help").out)) help.insert(option.flag);
  for (const auto& [refused, message] :
       {std::pair{"--deep d.exr", "dapple plan knows no deep files"},
        {"--resume d.ckpt", "dapple plan plans whole renders"},
        {"--resume-or-begin d.ckpt", "dapple plan plans whole renders"},
        {"--target-rmse 0.1", "dapple plan needs --spp"},
        {"--target-error 0.2 --max-spp 32", "dapple plan needs --spp"},
        {"--frame 0 --shutter 0,0.5 --motion-samples 2",
         "dapple plan does not support moving scenes"}}) {
    expect_failure(dapple("plan" + kTree + refused), 2, message);
    std::istringstream words(refused);
    for (std::string word; words >> word;)
      EXPECT_TRUE(word == "--frame" || !help.contains(word)) << word;
  }
  expect_all_options_given("plan");
  expect_files({"a.json"});
  EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
}

TEST_F(GoodValues, OfBakeMakeAFile) {
  const std::string tree = "bake 'scene:tree?leaves=50' ";
  const std::string saved =
      "--passes ao,bent,light --lights lights.json --light-rays 2 --channel _AO --bent-channel "
      "NORMAL --to vertex --at vertices --rays 8 --sides max --normals geometric --estimator exact "
      "--seed 3 --opacity leaf=0.5 --ground --ao-distance 2 --ao-falloff 1.5 --cache trees " +
      kKernels;
  run(tree + saved +
      "-o a.glb --png a.png --stats-json a.json --checkpoint a.ckpt "
      "--checkpoint-every 1h -q");
  run(tree + saved + "-o b.glb --resume a.ckpt");
  EXPECT_TRUE(bytes_of(path("a.glb")) == bytes_of(path("b.glb")));
  run(tree +
      "-o c.glb --passes ao,light --dome sky.hdr --dome-rotation 90 --light-radius 0.2 "
      "--target-error 0.1 --footprint 1 --report-bias 10% --max-bias 0.1 --instances unique "
      "--blend replace --allow-outside --occluders stage.glb");
  run("bake scene:cube?divisions=1 -o d.glb --to texture --size 64 --bits 16 --margin 2 --uv own "
      "--rays 8");
  run("bake 'scene:forest?trees=2&leaves=20&species=1' -o e.glb --to instance --rays 8");
  expect_all_options_given("bake");
  expect_files({"a.glb", "a.png", "a.json", "a.ckpt", "c.glb", "d.glb", "e.glb"});
}

TEST_F(GoodValues, OfPointsMakeATable) {
  write_bytes(path("at.csv"), "x,y,z\n0,0.1,0\n1,2,3\n");
  write_bytes(path("suns.csv"), "azimuth,elevation,irradiance\n90,45,800\n");
  const std::string tree = "points 'scene:tree?leaves=50' --rays 16 ";
  run(tree +
      "-o a.csv --at at.csv --bent --rings 5 --suns suns.csv --per-sun --sky overcast "
      "--sky-irradiance 100 --opacity leaf=0.5 --ground --estimator exact --seed 2 --cache trees "
      "--stats-json a.json -q " +
      kKernels);
  run(tree +
      "-o b.npy --grid=-1,-1,1,1,1 --height 0.5 --sky sky.hdr --sky-rotation 90 --periodic "
      "10,10 --footprint 0.5 --report-bias 10% --max-bias 0.1 --allow-outside");
  run("points scene:cube?divisions=1 -o c.ply --per-triangle --rays 16 --lights lights.json "
      "--light-radius 0.2 --ao-distance 2 --ao-falloff 1");
  expect_all_options_given("points");
  expect_files({"a.csv", "a.json", "b.npy", "c.ply"});
}

TEST_F(GoodValues, OfMergeMakeAPictureOfWhichCompareTellsTheDifferences) {
  for (const char* shard : {"1", "2"})
    ASSERT_EQ(dapple("render scene:cube?divisions=1 --width 8 --height 8 --spp 2 --shard " +
                     std::string(shard) + "/2 -o " + shard + ".dapple")
                  .code,
              0);
  run("merge 1.dapple 2.dapple -o a.exr");
  run("merge 1.dapple 2.dapple -o b.exr --png b.png --exposure 1 --background none --half ao "
      "--multipart --compression dwaa --stats-json b.json -q");
  expect_all_options_given("merge");
  expect_files({"a.exr", "b.exr", "b.png", "b.json"});
  run("compare b.exr a.exr --layer ao --png c.png --html c.html --max-rmse 0.01 --scale 4");
  run("compare b.exr a.exr --json");
  expect_all_options_given("compare");
  expect_files({"c.png", "c.html"});
}

TEST_F(GoodValues, OfSceneAndInfoTellOfASceneAndOfDevicesOfDevices) {
  run("scene cube divisions=2 -o a.glb -q");
  expect_all_options_given("scene");
  expect_files({"a.glb"});
  run("info a.glb --opacity cube=0.5 --lights lights.json --cache trees --json");
  run("info stage.glb --frame 0.5 --animation climb --line-radius 0.01 --allow-outside");
  expect_all_options_given("info");
  run("devices --check --kernel-dir '" DAPPLE_SOURCE_FOLDER "/kernels'");
  expect_all_options_given("devices");
}

}  // namespace
}  // namespace dapple
