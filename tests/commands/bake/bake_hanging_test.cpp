// A bake whose driver hangs: SIGTERM ends it within two seconds, as it ends renders, and the last
// checkpoint is whole.
#include <gtest/gtest.h>

#include "support/programs/bake_command.hpp"
#include "support/programs/hanging_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class HangingBake : public BakeCommand {
 protected:
  /// A bake of a texture so large that it does not end during a test.
  [[nodiscard]] std::vector<std::string> bake(std::vector<std::string> more) const {
    std::vector<std::string> arguments{
        "bake", path("in.glb"), "-o", path("out.glb"), "--to", "texture", "--size",
        "4096", "--rays",       "64", "--report-bias", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] std::string log() const { return (logs() / "log").string(); }
};

/// A copy of the kernels in which one slice of rays in eight never ends: of these bakes the sixth.
void copy_kernels_that_hang(const std::filesystem::path& to) {
  std::filesystem::copy(DAPPLE_SOURCE_FOLDER "/kernels", to,
                        std::filesystem::copy_options::recursive);
  for (const char* name : {"occlusion/ao.cl", "scalar/ao_scalar.cl"}) {
    const std::string file = to / name;
    std::string text = bytes_of(file);
    const std::size_t at = text.find(" return;\n");
    ASSERT_NE(at, std::string::npos) << name;
    text.insert(at + 9,
                "  if ((params.seed & 7u) == 4u)\n"
                "    for (volatile uint i = 1u; i; i = 1u) {}\n");
    write_bytes(file, text);
  }
}

TEST_F(HangingBake, IsLeftTwoSecondsAfterSIGTERMWithTheLastCheckpoint) {
  ASSERT_EQ(dapple("scene 'scene:tree?leaves=500' -o in.glb").code, 0);
  copy_kernels_that_hang(logs() / "kernels");
  RunningProgram program(bake({"--checkpoint", path("b.ckpt"), "--checkpoint-every", "0.02",
                               "--kernel-dir", (logs() / "kernels").string()}),
                         log());
  const auto is_saved = [&] {
    return program.has_ended() || std::filesystem::exists(path("b.ckpt"));
  };
  ASSERT_TRUE(wait_until(is_saved, kLongest)) << bytes_of(log());
  // Until no checkpoint was written for ten seconds.
  const auto written = [&] { return std::filesystem::last_write_time(path("b.ckpt")); };
  for (auto last = written();; last = written()) {
    std::this_thread::sleep_for(Milliseconds(10'000));
    if (written() == last) break;
  }
  expect_end_in_two_seconds(program, log());
  EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
  // The checkpoint is whole: nothing is wrong with it but that it was made with these kernels.
  RunningProgram again(bake({"--resume", path("b.ckpt")}), log());
  EXPECT_EQ(again.wait(), 2);
  EXPECT_TRUE(contains(bytes_of(log()), "differs from this run in kernels")) << bytes_of(log());
  EXPECT_EQ(files_in_folder(), 2U) << "the scene and the checkpoint";
}

}  // namespace
}  // namespace dapple
