// dapple plan as users call it: its sizes are compared with the files and the memory of the render
// that it plans; what it refuses, and that it writes nothing but its statistics.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/programs/program_run.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class PlanCommand : public ProgramRun {
 protected:
  /// The statistics of a plan. `timeout` starts the program: the system counts the memory of the
  /// process that forks, too, and that of the tests may be large.
  [[nodiscard]] nlohmann::json plan(const std::string& options) const {
    const Outcome run = dapple("plan -q " + options + " --stats-json plan.json", "timeout 600");
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.out + run.err, "");
    return nlohmann::json::parse(bytes_of(path("plan.json")));
  }
};

/// The most memory, in bytes, that the program had until the last time that one could look. Not
/// that of wait4(), which counts the process that forked, too.
double peak_bytes(RunningProgram& program) {
  double kilobytes = 0;
  const auto look = [&] {
    const std::string status = bytes_of("/proc/" + std::to_string(program.process()) + "/status");
    const std::size_t at = status.find("VmHWM:");
    if (at != std::string::npos) kilobytes = std::stod(status.substr(at + 6));
    return program.has_ended();
  };
  EXPECT_TRUE(wait_until(look, kLongest));
  return 1024 * kilobytes;
}

void expect_within(double value, double expected, double factor, const char* what) {
  EXPECT_GT(value, expected / factor) << what;
  EXPECT_LT(value, expected * factor) << what;
}

TEST_F(PlanCommand, WritesNothingButItsStatistics) {
  const Outcome run = dapple(
      "plan 'scene:tree?leaves=1000' --width 300 --height 200 --spp 8 --shard 1/2 --stats-json "
      "plan.json");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "a shard: about ")) << run.out;
  EXPECT_EQ(files_in_folder(), 1u);
  const auto json = nlohmann::json::parse(bytes_of(path("plan.json")));
  EXPECT_EQ(json.at("camera_rays"), 300 * 200 * 8);
  EXPECT_EQ(json.at("shards"), 2);
  EXPECT_GT(json.at("shard").at("seconds_of_rays"), 0);
}

// The render takes a second or two. It comes first: then kernels are compiled.
TEST_F(PlanCommand, SecondsAreThoseOfTheRenderOnAMachineThatDoesNothingElse) {
  const std::string options = "'scene:tree?leaves=20000' --width 240 --height 160 --spp 96";
  ASSERT_EQ(dapple("render " + options + " -q -o out.exr --stats-json render.json").code, 0);
  const auto render = nlohmann::json::parse(bytes_of(path("render.json")));
  const auto planned = plan(options);
  // Programs that begin or end meanwhile change both by a factor.
  expect_within(planned.at("shard").at("seconds_of_rays"), render.at("seconds").at("trace"), 4,
                "seconds of rays");
}

// Where trials are slow, sizes are those of an image of a fifth of the pixels, times five. Small
// images have more edges in a pixel and compress a little less. A trial's part has all samples, and
// sums of twice the samples are larger numbers. Memory is also what is kept of earlier trials.
TEST_F(PlanCommand, SizesAndMemoryAreThoseOfTheRender) {
  constexpr int kWidth = 240, kHeight = 160;
  const std::string scene = "scene:tree?leaves=1000", shard = " --spp 8 --shard 1/2";
  const auto of_size = [&](int width, int height) {
    return "'" + scene + "' --width " + std::to_string(width) + " --height " +
           std::to_string(height);
  };
  // This comes first, so that no other run compiles kernels, which takes much memory.
  ASSERT_EQ(dapple("render " + of_size(kWidth, kHeight) + " --spp 8 -o out.exr").code, 0);
  RunningProgram render(
      {"render", scene, "--width", std::to_string(kWidth), "--height", std::to_string(kHeight),
       "--spp", "8", "--shard", "1/2", "-o", path("part.dapple")},
      (logs() / "render").string());
  const double needed = peak_bytes(render);
  ASSERT_EQ(render.wait(), 0) << bytes_of((logs() / "render").string());

  const auto size = [&](const char* file) {
    return static_cast<double>(bytes_of(path(file)).size());
  };
  const nlohmann::json planned = plan(of_size(kWidth, kHeight) + shard);
  expect_within(planned.at("image_bytes"), size("out.exr"), 1.5, "image");
  expect_within(planned.at("part_bytes"), size("part.dapple"), 2, "part");
  if (kSanitized) return;  // it keeps freed memory
  expect_within(planned.at("memory_bytes"), needed, 2.5, "memory");
  constexpr int kMore = 3 * kWidth * 3 * kHeight - kWidth * kHeight;
  const nlohmann::json larger = plan(of_size(3 * kWidth, 3 * kHeight) + shard);
  const double grown =
      larger.at("memory_bytes").get<double>() - planned.at("memory_bytes").get<double>();
  // A pixel has more than twenty sums of eight bytes; with its layers, and all of that twice, it
  // has some 900 bytes.
  EXPECT_GT(grown, 20.0 * 8 * kMore);
  EXPECT_LT(grown, 2000.0 * kMore);
}

TEST_F(PlanCommand, WhatItCannotPlanIsRefused) {
  write_bytes(path("part.dapple"), "a part");
  expect_failure(dapple("plan scene:cube --target-rmse 0.1"), 2, "dapple plan needs --spp");
  expect_failure(dapple("plan scene:cube --resume a.ckpt"), 2, "leave --resume out");
  expect_failure(dapple("plan scene:cube --stats-json no/p.json"), 2, "there is no folder");
  expect_failure(dapple("plan part.dapple --stats-json part.dapple"), 2, "would overwrite");
  expect_failure(dapple("plan scene:cube --crop 9,9,4,4"), 2, "has no pixels");
  EXPECT_EQ(bytes_of(path("part.dapple")), "a part");
}

}  // namespace
}  // namespace dapple
