// Every option of every command that takes a value: without one, with a word or NaN in place of a
// number, with zeros before a number, and with a word that is none of an option's choices. The
// options are those of the help.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dapple/film.hpp"
#include "support/programs/command_help.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using program_test::Option;
using program_test::options_in;

class OptionValues : public program_test::ProgramRun {};

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
    {"devices", "--check"},
};

/// Options that take any text, most of them paths.
const std::set<std::string> kFreeText = {
    "--output",          "--half",       "--deep",      "--png",
    "--camera",          "--lights",     "--dome",      "--device",
    "--kernel-dir",      "--cache",      "--resume",    "--stats-json",
    "--occluders",       "--html",       "--at",        "--suns",
    "--layer",           "--checkpoint", "--animation", "--sky",
    "--resume-or-begin",
};

TEST_F(OptionValues, AreOfEveryCommand) {
  std::set<std::string> commands;
  for (const auto& [command, rest] : kCommands) commands.insert(command);
  EXPECT_EQ(commands, program_test::commands_in(dapple("--help").out));
}

TEST_F(OptionValues, NeedAValue) {
  std::size_t count = 0;
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      if (option.type.empty()) continue;
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
      if (option.type.empty() || (option.type == "TEXT" && kFreeText.contains(option.flag)))
        continue;
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

/// What a command needs beside an option.
std::string needs_of(const std::string& command, const std::string& flag) {
  if (flag == "--max-spp") return " --target-rmse 0.1";
  if (flag == "--motion-samples") return " --frame 0 --shutter 0,0.5";
  if (flag == "--back-every") return " --passes ao,back";
  if (command != "bake") return "";
  if (flag == "--light-rays") return " --passes ao,light";
  return flag == "--rays" ? "" : " --to texture";
}

TEST_F(OptionValues, OfWholeNumbersTheHelpTellsThoseThatAreTaken) {
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      if (option.type != "INT") continue;
      SCOPED_TRACE(command + " " + option.flag);
      const std::size_t dots = option.values.find("..");
      if (dots == std::string::npos) {
        EXPECT_TRUE(option.values.starts_with("{")) << option.values;
        continue;
      }
      const std::string low = option.values.substr(0, dots), high = option.values.substr(dots + 2);
      for (const int value : {std::stoi(low) - 1, std::stoi(high) + 1}) {
        const std::string others = option.flag == "--spp" ? "scene:cube -o o.exr" : rest;
        const std::string arguments = command + " " + others + needs_of(command, option.flag) +
                                      " " + option.flag + "=" + std::to_string(value);
        expect_failure(dapple(arguments), 2,
                       option.flag + " is " + std::to_string(value) + "; it must be from " + low +
                           " to " + high);
      }
    }
  }
}

TEST_F(OptionValues, OfNumbersWithARangeTheErrorTellsIt) {
  std::size_t count = 0;
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      const std::size_t dots = option.values.find("..");
      if (option.type != "FLOAT" || dots == std::string::npos) continue;
      SCOPED_TRACE(command + " " + option.flag);
      const std::string range =
          " from " + option.values.substr(0, dots) + " to " + option.values.substr(dots + 2);
      const std::string begin = command + " " + rest + " " + option.flag + "=";
      expect_failure(dapple(begin + "word"), 2, "expected a number" + range);
      const std::string beyond = "2e+30";  // than any of them
      expect_failure(dapple(begin + beyond), 2, option.flag);
      ++count;
    }
  }
  EXPECT_GT(count, 12u);
}

TEST_F(OptionValues, OutOfRangeAreNamedAsTyped) {
  const std::pair<const char*, const char*> cases[] = {
      {"--spp 99999999999999999999",
       "--spp 99999999999999999999: expected a whole number from 1 to 1048576"},
      {"--spp -99999999999999999999",
       "--spp -99999999999999999999: expected a whole number from 1 to 1048576"},
      {"--camera-splitting two", "--camera-splitting two: expected one of 0, 1, 2, 4"},
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

TEST_F(OptionValues, OfWholeNumbersAreDecimalWithZerosBeforeThemToo) {
  const program_test::Outcome run = dapple(
      "render scene:cube?divisions=1 --seed 0010 --spp=0008 --width 0016 --height 00008 -q -o "
      "out.exr");
  ASSERT_EQ(run.code, 0) << run.err;
  const Film film = read_exr(path("out.exr"));
  EXPECT_EQ(film.metadata.seed, 10u);
  EXPECT_EQ(film.metadata.samples, 8);
  EXPECT_EQ(film.width, 16);
  EXPECT_EQ(film.height, 8);
  std::filesystem::remove(path("out.exr"));
  for (const auto& [command, rest] : kCommands) {
    for (const Option& option : options_in(dapple(command + " --help").out)) {
      if (option.type != "INT" && option.type != "UINT") continue;
      for (const char* value : {"0x10", "0X8"}) {
        SCOPED_TRACE(command + " " + option.flag + " " + value);
        expect_failure(dapple(command + " " + rest + " " + option.flag + " " + value), 2,
                       option.flag + ": " + value + " is not a decimal number");
      }
    }
  }
  EXPECT_EQ(files_in_folder(), 0u);
}

}  // namespace
}  // namespace dapple
