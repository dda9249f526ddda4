// The command line of the program: exit codes, messages that name the wrong option or file, the
// files that a successful run writes, and no files after a failure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "dapple/shared/ray.h"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

using program_test::Outcome;

class CommandLine : public program_test::ProgramRun {
 protected:
  /// All commands, as `dapple --help` lists them.
  [[nodiscard]] std::vector<std::string> commands() const {
    const std::string help = dapple("--help").out;
    std::istringstream lines(help.substr(std::min(help.size(), help.find("\nSubcommands:\n"))));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);)
      if (line.size() > 2 && line.starts_with("  ") && line[2] != ' ')
        names.push_back(line.substr(2, line.find(' ', 2) - 2));
    EXPECT_GE(names.size(), 9u) << help;
    return names;
  }
};

TEST_F(CommandLine, HelpOfEveryCommandHasAnExample) {
  std::vector<std::string> all = commands();
  all.emplace_back("");  // the program itself
  for (const std::string& command : all) {
    SCOPED_TRACE(command);
    const Outcome run = dapple(command + " --help");
    EXPECT_EQ(run.code, 0);
    EXPECT_TRUE(contains(run.out, "Example")) << run.out;
    EXPECT_TRUE(contains(run.out, "\n  dapple " + command)) << run.out;
    EXPECT_EQ(run.err, "");
  }
  EXPECT_TRUE(contains(dapple("--help").out, "Exit codes"));
  const Outcome version = dapple("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("dapple ", 0), 0u) << version.out;
}

TEST_F(CommandLine, TheVerboseVersionSaysHowItWasBuiltAndWhichDevicesThereAre) {
  const Outcome run = dapple("--version --verbose");
  EXPECT_EQ(run.code, 0) << run.err;
  for (const char* part :
       {"dapple ", "\nbuild: ", "\ncompiler: ", "\ndevice: ", "\ndevice library: "})
    EXPECT_TRUE(contains(run.out, part)) << part << run.out;
  const Outcome bare = dapple("--version --verbose", "OCL_ICD_VENDORS=/nowhere");
  EXPECT_EQ(bare.code, 0);
  EXPECT_TRUE(contains(bare.out, "device: none")) << bare.out;
  expect_failure(dapple("--verbose"), 2, "subcommand");
}

/// The options that a help defines, from lines such as "  -o,--output TEXT   File to write".
std::vector<std::string> flags_in(const std::string& help) {
  std::vector<std::string> flags;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find("--");
    if (!line.starts_with("  -") || at > 5) continue;
    const std::size_t end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
    flags.push_back(line.substr(at, end - at));
  }
  return flags;
}

/// What a manual page ("man") or completions ("bash", "zsh") say about a command.
std::string part_about(const std::string& command, const std::string& kind,
                       const std::string& text) {
  std::string begin = "\n    " + command + ") options=\"", end = "\" ;;";
  if (kind == "zsh") {
    begin = "\n  " + command + ") _arguments";
    end = "'*:file:_files' ;;";
  } else if (kind == "man") {
    begin = end = "\n.SH ";
    for (const char letter : command) begin += static_cast<char>(std::toupper(letter));
    begin += '\n';
  }
  const std::size_t found = text.find(begin);
  if (found == std::string::npos) return {};
  const std::size_t at = found + begin.size();
  return text.substr(at, text.find(end, at) - at);
}

/// How they write an option, with what ends its name.
std::string written(const std::string& flag, const std::string& kind) {
  if (kind == "bash") return " " + flag + " ";
  if (kind == "zsh") return "'*" + flag + "[";
  std::string escaped;
  for (const char c : flag) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
  return "\\fB" + escaped + "\\fR";
}

TEST_F(CommandLine, ManualPageAndCompletionsNameEveryOptionOfEveryCommand) {
  std::map<std::string, std::string> texts;
  for (const char* kind : {"man", "bash", "zsh"}) {
    const Outcome run = dapple(std::string("document ") + kind);
    EXPECT_EQ(run.code, 0) << run.err;
    texts[kind] = run.out;
  }
  for (const std::string& command : commands()) {
    const std::vector<std::string> flags = flags_in(dapple(command + " --help").out);
    EXPECT_GE(flags.size(), 2u) << command << ": --help, and one of its own";
    for (const auto& [kind, text] : texts) {
      const std::string part = " " + part_about(command, kind, text) + " ";
      for (const std::string& flag : flags)
        EXPECT_TRUE(contains(part, written(flag, kind))) << kind << " of " << command << flag;
    }
  }
  expect_failure(dapple("document fish"), 2, "man, bash or zsh");
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
      {"--back-every 0", "--back-every"},
      {"--multipart=foo", "--multipart"},
      {"--footprint nan", "--footprint"},
      {"--footprint -1", "--footprint"},
      {"--report-bias 101", "--report-bias"},
      {"--report-bias many", "--report-bias"},
      {"--max-bias 2", "--max-bias"},
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
      {"--normals smooth", "--normals"},
      {"--exposure bright", "--exposure"},
      {"--exposure nan", "--exposure"},
      {"--exposure 1000", "--exposure"},
      {"--background blue", "--background"},
      {"--background 0,0,2", "--background"},
      {"--ambient -1", "--ambient"},
      {"--passes ao,", "--passes"},
      {"--passes ''", "--passes"},
      {"--estimator foo", "--estimator"},
      {"--compression foo", "--compression foo: it is zip"},
      {"--compression dwaa", "--compression dwaa needs --multipart"},
      {"--half Z", "--half Z: this layer stays 32-bit"},
      {"--half ao,", "--half ao,"},
      {"--look-from 0,1,2", "--look-at"},
      {"--look-from 0,1,2 --look-at 0,1,0 --camera top", "--camera does not go with --look-from"},
      {"--look-from 0,1,2 --look-at 0,1", "--look-at"},
      {"--look-from 0,1,2 --look-at 0,1,2", "from and at are the same point"},
      {"--fov 180", "--fov"},
      {"--light-radius -1", "--light-radius"},
      {"--light-radius nan", "--light-radius"},
      {"--camera nosuch", "--camera"},
      {"--opacity nosuch=0.5", "cube"},  // must list the scene's materials
      {"--opacity cube=2", "cube"},
      {"--opacity cube=nan", "cube"},
      {"--opacity cube=", "--opacity cube"},
      {"--opacity cube", "--opacity cube"},
  };
  for (const auto& [arguments, part] : cases) {
    SCOPED_TRACE(arguments);
    expect_failure(render(arguments), 2, part);
    EXPECT_EQ(files_in_folder(), 0u);
    std::filesystem::remove(path("out.exr"));  // so that a left file fails only one case
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

TEST_F(CommandLine, MissingArgumentsAreUsageErrors) {
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

TEST_F(CommandLine, AllowOutsideLetsASceneReadBesideItsFolder) {
  std::filesystem::create_directory(path("scene"));
  std::string triangle(36, '\0');
  const float one = 1;
  triangle.replace(12, 4, reinterpret_cast<const char*>(&one), 4);
  triangle.replace(28, 4, reinterpret_cast<const char*>(&one), 4);
  write_bytes(path("a.bin"), triangle);
  write_bytes(path("scene/scene.gltf"), R"({"asset": {"version": "2.0"},
    "buffers": [{"uri": "../a.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]})");
  expect_failure(dapple("info scene/scene.gltf"), 3, "--allow-outside");
  EXPECT_EQ(dapple("info scene/scene.gltf --allow-outside").code, 0);
  const std::string render = "render scene/scene.gltf --width 8 --height 8 --spp 1 -q -o ";
  expect_failure(dapple(render + "a.exr"), 3, "buffer 0");
  EXPECT_EQ(dapple(render + "a.exr --allow-outside").code, 0);
  expect_failure(dapple(render + "a.bin --allow-outside"), 2, "--output a.bin: would overwrite");
}

TEST_F(CommandLine, ProceduralParametersOutOfRangeAreNamedAtOnce) {
  for (const char* query :
       {"leaves=1e12", "leaves=nan", "leaves=-5", "leaves=1e400", "leaves=", "leaves=1.5",
        "leaves=5&leaves=6", "leaves", "leaves=0x10", "leaves= 5"}) {
    expect_failure(dapple("render 'scene:tree?" + std::string(query) + "' -o out.exr"), 2,
                   "leaves");
  }
  expect_failure(dapple("render 'scene:tree?height=inf' -o out.exr"), 2, "height");
  expect_failure(dapple("render 'scene:tree?nosuch=1' -o out.exr"), 2, "nosuch");
  expect_failure(dapple("render 'scene:tree?=1' -o out.exr"), 2, "scene:tree");
  expect_failure(dapple("render 'scene:' -o out.exr"), 2, "scene:");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(CommandLine, APictureBeyondTheMachinesMemoryIsRefusedBeforeRendering) {
  expect_failure(dapple("render scene:cube -o out.exr --width 65535 --height 65535"), 2, "--width");
  EXPECT_EQ(files_in_folder(), 0u);
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

TEST_F(CommandLine, AQuietRenderPrintsNothingAndWritesItsThreeFiles) {
  const Outcome run = render("--quiet --png out.png --stats-json out.json --seed 3");
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out + run.err, "");
  EXPECT_EQ(files_in_folder(), 3u);
  EXPECT_EQ(read_exr(path("out.exr")).width, 8);
  EXPECT_EQ(bytes_of(path("out.png")).substr(1, 3), "PNG");
  const auto json = nlohmann::json::parse(bytes_of(path("out.json")));
  double sum = 0;
  for (const char* key : {"load", "prepare", "cache", "build", "prefilter", "refit", "upload",
                          "kernel_build", "trace", "checkpoint", "develop", "write"}) {
    EXPECT_GE(json.at("seconds").at(key).get<double>(), 0) << key;
    sum += json.at("seconds").at(key).get<double>();
  }
  const double total = json.at("seconds").at("total").get<double>();
  EXPECT_NEAR(sum, total, 0.01 + 0.05 * total);
  EXPECT_GE(json["seconds"]["total"].get<double>(), json["seconds"]["trace"].get<double>());
  EXPECT_EQ(json.at("rays").at("camera"), 64);
  // Each sample that hit a surface has two AO rays, and one ray each to the sun and the sky.
  EXPECT_EQ(json.at("rays").at("ao"), json.at("rays").at("light"));
  EXPECT_GT(json["rays"]["light"], 0);
  EXPECT_LE(json["rays"]["light"], 128);
  EXPECT_EQ(json.at("triangles"), 12);
  EXPECT_GT(json.at("nodes"), 0);
  EXPECT_TRUE(json.at("bytes").is_object());
  EXPECT_NE(json.at("device"), "");
  EXPECT_EQ(json.at("estimator"), "prefiltered");
}

TEST_F(CommandLine, ARenderReportsItsOutputAndACropKeepsItsPosition) {
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
  // The camera rays of a work-item visit the root together. The sum of the pixels' means equals the
  // visits that the statistics count.
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
  EXPECT_EQ(read_exr(path("out.exr")).find("visits.nodes"), nullptr) << "only with --passes visits";
}

TEST_F(CommandLine, OnePixelAndOneColumnArePictures) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 8192}, {8192, 1}}) {
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
  const Outcome quiet = dapple("scene tree leaves=100 -o quiet.glb -q");
  EXPECT_EQ(quiet.code, 0) << quiet.err;
  EXPECT_EQ(quiet.out, "");
  const Outcome run = dapple(
      "render tree.glb -o tree.exr --opacity leaf=0.5 --ground --width 8 --height 8 --spp 1 -q");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(read_exr(path("tree.exr")).width, 8);
}

TEST_F(CommandLine, InfoAndDevicesPrintTheSceneAndTheDevices) {
  const Outcome json_run = dapple("info 'scene:cube?divisions=2' --json");
  EXPECT_EQ(json_run.code, 0);
  const auto json = nlohmann::json::parse(json_run.out);
  EXPECT_EQ(json.at("triangles").at("total"), 48);
  EXPECT_EQ(json.at("materials").at(0), "cube");
  EXPECT_EQ(json.at("bounds").at("max").at(1), 1.0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(json.at("opacity").at(axis), 0.95);
  const Outcome text_run = dapple("info 'scene:cube?divisions=2' --opacity cube=0.5");
  EXPECT_EQ(text_run.code, 0);
  EXPECT_TRUE(contains(text_run.out, "bounds      (-0.5, 0, -0.5) to (0.5, 1, 0.5) m"))
      << text_run.out;
  EXPECT_TRUE(contains(text_run.out, "48")) << text_run.out;
  EXPECT_TRUE(contains(text_run.out, "48 translucent")) << text_run.out;
  EXPECT_TRUE(contains(text_run.out, " all per triangle")) << text_run.out;
  const Outcome strands = dapple("info 'scene:hair?strands=10'");
  EXPECT_TRUE(contains(strands.out, " per primitive")) << strands.out;
  const Outcome devices = dapple("devices");
  EXPECT_EQ(devices.code, 0);
  EXPECT_TRUE(contains(devices.out, "compute units")) << devices.out;
}

}  // namespace
}  // namespace dapple
