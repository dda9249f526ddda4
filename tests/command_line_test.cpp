// The program as its users meet it: exit codes, messages that name what is wrong, nothing
// left behind by a failure, and the files of a success.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "dapple/shared/ray.h"
#include "program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

using program_test::Outcome;

class CommandLine : public program_test::ProgramRun {};

TEST_F(CommandLine, HelpOfEveryCommandHasAnExample) {
  for (const char* arguments :
       {"--help", "render --help", "info --help", "scene --help", "devices --help"}) {
    const Outcome run = dapple(arguments);
    EXPECT_EQ(run.code, 0) << arguments;
    EXPECT_TRUE(contains(run.out, "Example:")) << arguments;
    EXPECT_TRUE(contains(run.out, "\n  dapple ")) << arguments;
    EXPECT_EQ(run.err, "") << arguments;
  }
  EXPECT_TRUE(contains(dapple("--help").out, "Exit codes"));
  const Outcome version = dapple("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("dapple ", 0), 0u) << version.out;
}

TEST_F(CommandLine, TheTwoTargetsExcludeEachOther) {
  const Outcome run = render("--target-error 0.1 --target-rmse 0.1");
  expect_failure(run, 2, "--target-error");
  expect_failure(run, 2, "--target-rmse");
  const Outcome one = render("--target-rmse 0.1");
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_TRUE(contains(one.out, "estimated RMSE: ao 0.")) << one.out;
}

TEST_F(CommandLine, UsageErrorsNameTheirFlagAndLeaveNothingBehind) {
  const std::pair<const char*, const char*> cases[] = {
      {"--no-such-flag", "--no-such-flag"},
      {"--spp 0", "--spp"},
      {"--spp -1", "--spp"},
      {"--spp 1e99", "--spp"},
      {"--spp abc", "--spp"},
      {"--spp 1.5", "--spp"},
      {"--spp", "--spp"},
      {"--seed -1", "--seed"},
      {"--seed 4294967296", "--seed"},
      {"--ao-rays 0", "--ao-rays"},
      {"--light-rays 5000", "--light-rays"},
      {"--footprint nan", "--footprint"},
      {"--footprint -1", "--footprint"},
      {"--ao-distance -1", "--ao-distance"},
      {"--ao-falloff 2", "--ao-distance"},
      {"--target-rmse 2", "--target-rmse"},
      {"--target-rmse nan", "--target-rmse"},
      {"--crop 0,0,8,7", "--crop"},
      {"--crop 5,5,4,4", "--crop"},
      {"--crop -1,0,4,4", "--crop"},
      {"--crop 1,2,3", "--crop"},
      {"--crop a,b,c,d", "--crop"},
      {"--crop 0,0,7,99999999999", "--crop"},
      {"--passes foo", "--passes"},
      {"--passes ao,", "--passes"},
      {"--passes ''", "--passes"},
      {"--estimator foo", "--estimator"},
      {"--look-from 0,1,2", "--look-at"},
      {"--look-from 0,1,2 --look-at 0,1", "--look-at"},
      {"--look-from 0,1,2 --look-at 0,1,2", "from and at are the same point"},
      {"--fov 180", "--fov"},
      {"--light-radius -1", "--light-radius"},
      {"--light-radius nan", "--light-radius"},
      {"--camera nosuch", "--camera"},
      {"--opacity nosuch=0.5", "cube"},  // the materials that there are
      {"--opacity cube=2", "cube"},
      {"--opacity cube=nan", "cube"},
      {"--opacity cube=", "--opacity cube"},
      {"--opacity cube", "--opacity cube"},
  };
  for (const auto& [arguments, part] : cases) {
    SCOPED_TRACE(arguments);
    expect_failure(render(arguments), 2, part);
    EXPECT_EQ(files_in_folder(), 0u);
    std::filesystem::remove(path("out.exr"));  // a leftover is this case's fault only
  }
}

TEST_F(CommandLine, PictureSizesOutOfRangeNameTheirFlag) {
  for (const char* flag : {"--width", "--height"}) {
    for (const char* value : {"0", "-1", "65536", "2147483648", "9e9", "abc"}) {
      const std::string arguments = std::string(flag) + " " + value;
      SCOPED_TRACE(arguments);
      expect_failure(dapple("render scene:demo -o out.exr " + arguments), 2, flag);
    }
  }
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(CommandLine, ACommandLineThatLacksSomethingIsAUsageError) {
  expect_failure(dapple(""), 2, "subcommand");
  expect_failure(dapple("nosuch"), 2, "nosuch");
  expect_failure(dapple("render scene:demo"), 2, "--output");
  expect_failure(dapple("render -o out.exr"), 2, "SCENE");
  expect_failure(dapple("scene -o x.glb"), 2, "NAME");
  expect_failure(dapple("scene nosuch -o x.glb"), 2, "nosuch");
  expect_failure(dapple("scene tree nosuch=1 -o x.glb"), 2, "nosuch");
  expect_failure(dapple("scene tree leaves=0 -o x.glb"), 2, "leaves");
  expect_failure(dapple("info scene:cube --opacity nosuch=1"), 2, "cube");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(CommandLine, AnOutputThatCannotBeWrittenIsFoundBeforeTheSceneIsRead) {
  std::filesystem::create_directory(path("folder"));
  for (const char* output : {"missing/out.exr", "folder", "folder/x/out.exr"}) {
    // The scene is missing too: code 2, not 3, says which was looked at first.
    expect_failure(dapple(std::string("render nosuch.glb -o ") + output), 2, output);
    expect_failure(dapple(std::string("render nosuch.glb -o a.exr --png ") + output), 2, output);
    expect_failure(dapple(std::string("render nosuch.glb -o a.exr --stats-json ") + output), 2,
                   output);
    expect_failure(dapple(std::string("scene tree -o ") + output), 2, output);
  }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(CommandLine, InputsThatCannotBeReadAreNamed) {
  write_bytes(path("text.glb"), "this is no glTF file");
  write_bytes(path("lights.json"), "{\"lights\": [");
  expect_failure(dapple("render nosuch.glb -o out.exr"), 3, "nosuch.glb");
  expect_failure(dapple("render text.glb -o out.exr"), 3, "text.glb");
  expect_failure(dapple("render . -o out.exr"), 3, ".");
  expect_failure(dapple("info nosuch.gltf"), 3, "nosuch.gltf");
  expect_failure(render("--lights nosuch.json"), 3, "nosuch.json");
  expect_failure(render("--lights lights.json"), 3, "lights.json");
  expect_failure(render("--opacity cube=0"), 3, "transparent");
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(CommandLine, AFailedWriteExitsWith1AndLeavesNothingBehind) {
  // A limit of one block a file stands in for a full disk; the message still fits.
  const Outcome run = dapple("scene cube -o x.glb", "trap '' XFSZ && ulimit -f 1 &&");
  expect_failure(run, 1, "x.glb");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(CommandLine, AQuietRenderPrintsNothingAndWritesItsThreeFiles) {
  const Outcome run = render("--quiet --png out.png --stats-json out.json --seed 3");
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out + run.err, "");
  EXPECT_EQ(files_in_folder(), 3u);
  EXPECT_EQ(read_exr(path("out.exr")).width, 8);
  EXPECT_EQ(bytes_of(path("out.png")).substr(1, 3), "PNG");
  const auto json = nlohmann::json::parse(bytes_of(path("out.json")));
  for (const char* key :
       {"load", "build", "prefilter", "upload", "kernel_build", "trace", "write", "total"}) {
    EXPECT_GE(json.at("seconds").at(key).get<double>(), 0) << key;
  }
  EXPECT_GE(json["seconds"]["total"].get<double>(), json["seconds"]["trace"].get<double>());
  EXPECT_EQ(json.at("rays").at("camera"), 64);
  // One AO and one light ray, the key light's, a sample that hit something.
  EXPECT_EQ(json.at("rays").at("ao"), json.at("rays").at("light"));
  EXPECT_GT(json["rays"]["ao"], 0);
  EXPECT_LE(json["rays"]["ao"], 64);
  EXPECT_EQ(json.at("triangles"), 12);
  EXPECT_GT(json.at("nodes"), 0);
  EXPECT_TRUE(json.at("bytes").is_object());
  EXPECT_NE(json.at("device"), "");
  EXPECT_EQ(json.at("estimator"), "prefiltered");
}

TEST_F(CommandLine, ARenderSaysWhatItMadeAndACropKeepsItsPlace) {
  const Outcome run = render("--crop 2,3,5,4 --estimator exact --passes ao");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "wrote out.exr")) << run.out;
  EXPECT_TRUE(contains(run.out, "exact on ")) << run.out;
  const Film film = read_exr(path("out.exr"));
  EXPECT_EQ(film.data_window, (PixelRect{2, 3, 5, 4}));
  EXPECT_EQ(film.width, 8);
  EXPECT_NE(film.find("ao.R"), nullptr);
}

TEST_F(CommandLine, VisitsAreALayerAndAHeatMapBesideThePreview) {
  const Outcome run = render("--passes ao,visits --png out.png --stats-json stats.json");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(bytes_of(path("out_visits.png")).substr(1, 3), "PNG");
  const Film film = read_exr(path("out.exr"));
  const Plane* nodes = film.find("visits.nodes");
  ASSERT_NE(nodes, nullptr);
  ASSERT_NE(film.find("visits.triangles"), nullptr);
  // Several beams of camera rays visit the root together; the means add up to what the statistics
  // count.
  double sum = 0;
  for (const float visits : nodes->pixels) sum += visits;
  EXPECT_GT(sum, 0);
  const auto json = nlohmann::json::parse(bytes_of(path("stats.json")));
  const double samples = film.find("samples")->pixels.front();
  double counted = 0;
  for (const char* kind : {"camera", "ao"})
    counted += json["node_visits_per_ray"][kind].get<double>() * json["rays"][kind].get<double>();
  EXPECT_NEAR(sum * samples, counted, 1e-3 * counted);
  EXPECT_EQ(render("--passes ao").code, 0);
  EXPECT_EQ(read_exr(path("out.exr")).find("visits.nodes"), nullptr) << "only when asked for";
}

TEST_F(CommandLine, OnePixelAndOneColumnArePictures) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 2000}, {2000, 1}}) {
    const Outcome run = dapple("render 'scene:cube?divisions=1' -o out.exr -q --spp 1 --width " +
                               std::to_string(width) + " --height " + std::to_string(height));
    ASSERT_EQ(run.code, 0) << run.err;
    const Film film = read_exr(path("out.exr"));
    EXPECT_EQ(film.width, width);
    EXPECT_EQ(film.height, height);
  }
}

TEST_F(CommandLine, AProceduralSceneAsAGlbFileRenders) {
  const Outcome made = dapple("scene tree leaves=100 -o tree.glb");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_TRUE(contains(made.out, "wrote tree.glb")) << made.out;
  const Outcome run = dapple(
      "render tree.glb -o tree.exr --opacity leaf=0.5 --ground --width 8 --height 8 --spp 1 -q");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(read_exr(path("tree.exr")).width, 8);
}

TEST_F(CommandLine, InfoAndDevicesTellWhatThereIs) {
  const Outcome json_run = dapple("info 'scene:cube?divisions=2' --json");
  EXPECT_EQ(json_run.code, 0);
  const auto json = nlohmann::json::parse(json_run.out);
  EXPECT_EQ(json.at("triangles").at("total"), 48);
  EXPECT_EQ(json.at("materials").at(0), "cube");
  EXPECT_EQ(json.at("bounds").at("max").at(1), 1.0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(json.at("opacity").at(axis), 0.95);
  const Outcome text_run = dapple("info 'scene:cube?divisions=2' --opacity cube=0.5");
  EXPECT_EQ(text_run.code, 0);
  EXPECT_TRUE(contains(text_run.out, "48")) << text_run.out;
  EXPECT_TRUE(contains(text_run.out, "48 translucent")) << text_run.out;
  const Outcome devices = dapple("devices");
  EXPECT_EQ(devices.code, 0);
  EXPECT_TRUE(contains(devices.out, "compute units")) << devices.out;
}

}  // namespace
}  // namespace dapple
