// Signals end bakes of the program: exit codes, no output or the one before, no temporary file, and
// a checkpoint from which the next run writes the file that a run without interruption does.
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "support/programs/bake_command.hpp"
#include "support/programs/processor_time.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class BakeInterruption : public BakeCommand {
 protected:
  /// Triangles in meshes of their own, which are traced one after the other: many moments to stop
  /// at.
  void write_meshes(int count) const {
    GltfBuilder builder;
    for (int i = 0; i < count; ++i) {
      const int node = builder.add_triangle();
      builder.doc["nodes"][node]["translation"] = {0.2 * (i % 5), 0.3 * (i / 5), 0.1 * i};
      builder.doc["scenes"][0]["nodes"].push_back(node);
    }
    write("in.glb", builder.glb());
  }

  [[nodiscard]] std::vector<std::string> bake(const std::string& scene,
                                              std::vector<std::string> more) const {
    std::vector<std::string> arguments{"bake", scene, "-o", path("out.glb"), "--channel", "_AO"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// 16,384 rays for each side of each triangle.
  [[nodiscard]] std::vector<std::string> bake_meshes(std::vector<std::string> more) const {
    more.insert(more.end(), {"--rays", "16384", "--report-bias", "0"});
    return bake(path("in.glb"), more);
  }

  /// Sends the signal when the third checkpoint is there: after the first samples there is
  /// something to save. More meshes are tried if the bake is done before. Returns the exit code.
  int interrupt_bake_of_meshes(int signal) const {
    for (int count = 32;; count *= 2) {
      write_meshes(count);
      std::filesystem::remove(path("a.ckpt"));
      write_bytes(path("out.glb"), "old");
      RunningProgram program(bake_meshes({"--checkpoint", path("a.ckpt"), "--checkpoint-every",
                                          "0.001", "--stats-json", path("a.json")}),
                             log());
      std::set<std::uintmax_t> sizes;
      EXPECT_TRUE(wait_until(
          [&] {
            if (is_there("a.ckpt")) sizes.insert(std::filesystem::file_size(path("a.ckpt")));
            return sizes.size() == 3 || program.has_ended();
          },
          kLongest))
          << bytes_of(log());
      program.send(signal);
      const int code = program.wait();
      if (code != 0 || count > 4096) return code;
    }
  }

  /// A bake of a procedural scene whose file is beside the output just now. On a busy machine the
  /// test may miss it; files of larger scenes are there for longer.
  [[nodiscard]] std::unique_ptr<RunningProgram> bake_with_file_of_scene(
      const std::vector<std::string>& more) const {
    for (int leaves = 40'000;; leaves *= 2) {
      auto program = std::make_unique<RunningProgram>(
          bake("scene:tree?leaves=" + std::to_string(leaves), more), log());
      const auto is_written = [&] { return temporary_files() == std::vector<bool>{true}; };
      EXPECT_TRUE(wait_until([&] { return is_written() || program->has_ended(); }, kLongest));
      if (is_written() || leaves > 1'000'000) return program;
      std::filesystem::remove(path("out.glb"));
      std::filesystem::remove(path("a.ckpt"));
    }
  }

  /// For each temporary file beside the output whether it has content.
  [[nodiscard]] std::vector<bool> temporary_files() const {
    std::vector<bool> found;
    std::error_code gone;
    for (const auto& file : std::filesystem::directory_iterator(folder_))
      if (file.path().filename().string().starts_with(".dapple-"))
        found.push_back(file.file_size(gone) > 0 && !gone);
    return found;
  }

  [[nodiscard]] std::string log() const { return (logs() / "log").string(); }
  [[nodiscard]] bool is_there(const std::string& name) const {
    return std::filesystem::exists(path(name));
  }
};

TEST_F(BakeInterruption, ASignalKeepsTheOutputAndLeavesACheckpointThatGoesOnToTheSameBits) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}}) {
    SCOPED_TRACE(code);
    ASSERT_EQ(interrupt_bake_of_meshes(signal), code) << bytes_of(log());
    EXPECT_TRUE(contains(bytes_of(log()), "note: interrupted, " + path("out.glb") +
                                              " is not written; --resume " + path("a.ckpt") +
                                              " goes on\n"))
        << bytes_of(log());
    EXPECT_EQ(bytes_of(path("out.glb")), "old");
    EXPECT_EQ(files_in_folder(), 4u) << "in.glb, out.glb, a.ckpt, a.json";
    const json told = json::parse(bytes_of(path("a.json")));
    EXPECT_TRUE(contains(told["notes"].back(), "interrupted, " + path("out.glb"))) << told["notes"];
    EXPECT_GT(told["rays"], 0);

    RunningProgram resumed(bake_meshes({"--resume", path("a.ckpt")}), log());
    ASSERT_EQ(resumed.wait(), 0) << bytes_of(log());
    const std::string said = bytes_of(log());
    const std::size_t from = said.find("went on from " + path("a.ckpt"));
    ASSERT_NE(from, std::string::npos) << said;
    // "F: 4,096 of 16,384 points": some, and not all.
    EXPECT_FALSE(contains(said.substr(from), ": 0 of ")) << said;
    const std::string whole = bytes_of(path("out.glb"));
    ASSERT_EQ(RunningProgram(bake_meshes({}), log()).wait(), 0) << bytes_of(log());
    EXPECT_TRUE(bytes_of(path("out.glb")) == whole);
    EXPECT_EQ(files_in_folder(), 4u);
  }
}

TEST_F(BakeInterruption, WithoutACheckpointItEndsAtOnceAndLeavesNothing) {
  write_meshes(1024);
  RunningProgram program(bake_meshes({}), log());
  std::this_thread::sleep_for(Milliseconds(400));
  const double used = processor_seconds(program.process());
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 130) << bytes_of(log());
  EXPECT_LT(processor_seconds(program.usage()) - used, kSanitized ? 60 : 1)
      << "its 34 million rays take several seconds";
  EXPECT_EQ(files_in_folder(), 1u);
}

// A procedural scene is written beside the output before it is read. There is nothing to save yet.
TEST_F(BakeInterruption, TheFileOfAProceduralSceneGoesWithTheProcess) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--checkpoint", path("a.ckpt")}}) {
    const auto program = bake_with_file_of_scene(more);
    program->send(SIGINT);
    EXPECT_EQ(program->wait(), 130) << bytes_of(log());
    EXPECT_EQ(files_in_folder(), 0u);
  }
}

TEST_F(BakeInterruption, AProcessThatIsKilledLeavesNothingThatItsNextRunDoesNotRemove) {
  const auto program = bake_with_file_of_scene({});
  program->send(SIGKILL);
  program->wait();
  EXPECT_FALSE(is_there("out.glb"));
  EXPECT_EQ(RunningProgram(bake("scene:tree?leaves=100", {}), log()).wait(), 0) << bytes_of(log());
  EXPECT_EQ(files_in_folder(), 1u);
}

}  // namespace
}  // namespace dapple
