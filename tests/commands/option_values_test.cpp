// Every option of every command that takes a value: without one, with a word or NaN in place of a
// number, with a word that is none of an option's choices, and with good values. The options are
// those of the help.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/program_run.hpp"

namespace dapple {
namespace {

using film_test::contains;
using program_test::Outcome;

class OptionValues : public program_test::ProgramRun {};

struct Option {
  std::string flag, type;  ///< "--spp", "INT"
};

/// Options with values, from lines such as "  -o,--output TEXT REQUIRED   OpenEXR file to write".
std::vector<Option> options_in(const std::string& help) {
  std::vector<Option> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t dashes = line.find("--");
    if (line.rfind("  -", 0) != 0 || dashes > 5) continue;
    std::istringstream words(line.substr(dashes));
    Option option;
    words >> option.flag >> option.type;
    option.type = option.type.substr(0, option.type.find('='));
    if (option.type == "TEXT" || option.type == "FLOAT" || option.type == "INT" ||
        option.type == "UINT")
      options.push_back(option);
  }
  return options;
}

/// Commands with what they need beside an option. What is not refused fails soon.
const std::vector<std::pair<std::string, std::string>> kCommands = {
    {"render", "scene:cube -o o.exr --spp 1"},
    {"bake", "scene:cube -o o.glb"},
    {"points", "scene:cube --per-triangle -o o.csv"},
    {"compare", "no.exr none.exr"},
    {"info", "scene:cube"},
    {"scene", "cube -o o.glb"},
    {"merge", "no.dapple -o o.exr"},
    {"plan", "scene:cube --spp 1"},
};

/// Options that take any text, most of them paths.
const std::set<std::string> kFreeText = {
    "--output", "--half",       "--deep",  "--png",        "--camera",     "--lights",    "--dome",
    "--device", "--kernel-dir", "--cache", "--resume",     "--stats-json", "--occluders", "--html",
    "--at",     "--suns",       "--layer", "--checkpoint", "--animation",  "--sky",
};

TEST_F(OptionValues, NeedAValue) {
  std::size_t count = 0;
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      SCOPED_TRACE(command + " " + option.flag);
      expect_failure(dapple(command + " " + rest + " " + option.flag), 2, option.flag);
      ++count;
    }
  }
  EXPECT_GT(count, 100u);
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(OptionValues, AreNumbersWhereNumbersAreExpectedAndNeverNaN) {
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      if (option.type == "TEXT" && kFreeText.contains(option.flag)) continue;
      for (const char* value : {"nan", "abc", "99999999999999999999999"}) {
        // Some lengths and times may be as large.
        if (value[0] == '9' && option.type != "INT" && option.type != "UINT") continue;
        SCOPED_TRACE(command + " " + option.flag + " " + value);
        expect_failure(dapple(command + " " + rest + " " + option.flag + " " + value), 2,
                       option.flag);
      }
    }
  }
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(OptionValues, OutOfRangeAreNamedAsTyped) {
  const std::pair<const char*, const char*> cases[] = {
      {"--spp 99999999999999999999",
       "--spp 99999999999999999999: expected a whole number from -2147483648 to"},
      {"--spp -99999999999999999999",
       "--spp -99999999999999999999: expected a whole number from -2147483648"},
      {"--shard 1/99999999999", "--shard: '99999999999' is out of range"},
      {"--report-bias 200%", "--report-bias 200%: expected 0% to 100%"},
      {"--report-bias -1", "--report-bias -1: expected 0% to 100%"},
      {"--fov 0", "--fov is 0; it must be from 0.01 to 179"},
      {"--exposure inf", "--exposure: 'inf' is not a number"},
      {"--look-from 0,0,1e99 --look-at 0,0,0", "--look-from: '1e99' is out of range"},
  };
  for (const auto& [arguments, text] : cases) {
    SCOPED_TRACE(arguments);
    expect_failure(dapple(std::string("render scene:cube -o o.exr ") + arguments), 2, text);
  }
}

/// Runs of `dapple render` that have every option that takes a value.
const std::vector<std::string> kGoodRuns = {
    "-o a.exr --exposure -1.5 --background 0.1,0.2,0.3 --png a.png --half ao,light.sun "
    "--compression piz --deep a_deep.exr --crop 2,1,9,7 --seed 7 --passes ao,light,albedo,back "
    "--back-every 4 --normals geometric --cryptomatte object,material --stats-json a.json",
    "-o b.exr --exposure auto --background none --png b.png --compression dwaa --multipart "
    "--half all --camera-splitting 2 --ao-rays 3 --light-rays 2 --footprint 2 --max-bias 0.05 "
    "--report-bias 50% --ambient 0.5 --normals shading --ao-distance 3 --ao-falloff 2",
    "-o c.exr --background sky --png c.png --look-from 0,1,6 --look-at 0,0.5,0 --up 0,1,0.1 "
    "--fov 30 --aperture 0.05 --focus-distance 6 --light-radius 0.2 --opacity leaf=0.5 "
    "--estimator exact --packets none --device - --kernel-dir '" DAPPLE_SOURCE_FOLDER
    "/kernels' --cache trees",
    "-o d.exr --lights lights.json --line-radius 0.01 --target-error 0.2 --max-spp 32 "
    "--checkpoint d.ckpt --checkpoint-every 5m",
    "-o e.exr --dome sky.hdr --dome-rotation 90 --frame 0.5 --fps 12 --shutter 0,0.5 "
    "--motion-samples 2 --passes ao,light",
    "-o 'f.#.exr' --frames 1-2 --fps 30 --passes ao,motion,visits --target-rmse 0.1",
    "-o g.dapple --shard 1/2",
    "-o h.exr --resume d.ckpt --lights lights.json --line-radius 0.01 --target-error 0.2 "
    "--max-spp 32",
};

/// Options whose good values need a glTF file of their own: tests/commands/frames_command_test.cpp
/// and tests/camera.
const std::set<std::string> kNeedFiles = {"--animation", "--camera"};

TEST_F(OptionValues, GoodOnesOfRenderMakeAPicture) {
  // A Radiance image of one white pixel.
  film_test::write_bytes(path("sky.hdr"),
                         "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81");
  film_test::write_bytes(
      path("lights.json"),
      R"({"lights": [{"type": "dome", "name": "clouds", "image": "sky.hdr", "exposure": -1},
                     {"type": "disk", "name": "lamp", "position": [0, 3, 0], "target": [0, 0, 0],
                      "radius": 0.5, "radiance": [9, 9, 9]}]})");
  std::set<std::string> given;
  for (const std::string& run : kGoodRuns) {
    const Outcome result =
        dapple("render 'scene:tree?leaves=500&wind=1' --width 16 --height 12 --spp 8 -q " + run);
    EXPECT_EQ(result.code, 0) << run << "\n" << result.err;
    std::istringstream words(run + " --width --height --spp");
    for (std::string word; words >> word;) given.insert(word == "-o" ? "--output" : word);
  }
  for (const Option& option : options_in(dapple("render --help").out))
    EXPECT_TRUE(given.contains(option.flag) || kNeedFiles.contains(option.flag)) << option.flag;
  for (const char* file :
       {"a.exr", "a.png", "a_deep.exr", "a.json", "b.exr", "b.png", "c.exr", "c.png", "d.exr",
        "d.ckpt", "e.exr", "f.1.exr", "f.2.exr", "g.dapple", "h.exr"})
    EXPECT_TRUE(std::filesystem::exists(path(file))) << file;
  const Film lit = read_exr(path("d.exr"));
  EXPECT_NE(lit.find("light.clouds.R"), nullptr);
  EXPECT_NE(lit.find("light.lamp.R"), nullptr);
}

}  // namespace
}  // namespace dapple
