// farm/slurm/task with a stub in place of srun, which writes its arguments to a file: what it runs
// at a first start and after a restart.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/film_files.hpp"

namespace dapple {
namespace {

using film_test::bytes_of;
using film_test::contains;

class SlurmTask : public film_test::FilmFile {
 protected:
  void SetUp() override {
    std::ofstream(path("srun")) << "#!/bin/sh\necho \"$@\" > '" + path("arguments") + "'\n";
    std::filesystem::permissions(path("srun"), std::filesystem::perms::owner_all);
  }

  /// Runs frame 3 of a sequence, which begins with frame `first`. Returns the exit code.
  [[nodiscard]] int frame(int restarts, const std::string& options = "", int first = 1) const {
    const std::string command =
        "cd '" + folder_.string() + "' && PATH=\"$PWD:$PATH\" " +
        "SLURM_ARRAY_TASK_ID=" + std::to_string(3 - first) +
        " SLURM_CPUS_PER_TASK=8 SLURM_RESTART_COUNT=" + std::to_string(restarts) +
        " bash '" DAPPLE_SOURCE_FOLDER "/farm/slurm/task' frame " + std::to_string(first) +
        "/24 f_%04d.exr tree.glb " + options;
    return WEXITSTATUS(std::system(command.c_str()));
  }
  [[nodiscard]] bool ran() const { return std::filesystem::exists(path("arguments")); }
};

TEST_F(SlurmTask, AFirstStartRemovesWhatAnEarlierJobLeft) {
  for (const char* name : {"f_0003.exr", "f_0003.exr.ckpt"}) std::ofstream(path(name)) << "old";
  EXPECT_EQ(frame(0), 0);
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr")));
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr.ckpt")));
  const std::string arguments = bytes_of(path("arguments"));
  EXPECT_TRUE(contains(arguments, "--frame 0.125 -o f_0003.exr")) << arguments;
  EXPECT_TRUE(contains(arguments, "--checkpoint f_0003.exr.ckpt")) << arguments;
  EXPECT_FALSE(contains(arguments, "--resume")) << arguments;
  EXPECT_TRUE(contains(arguments, "--ntasks=1 --cpus-per-task=8 ")) << arguments;
  EXPECT_EQ(frame(0, "", 3), 0);
  EXPECT_EQ(bytes_of(path("arguments")), arguments);
}

TEST_F(SlurmTask, ARestartGoesOnOrKnowsThatItWasDone) {
  std::ofstream(path("f_0003.exr.ckpt")) << "state";
  EXPECT_EQ(frame(1), 0);
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "--resume f_0003.exr.ckpt"));
  std::filesystem::remove(path("arguments"));
  std::ofstream(path("f_0003.exr")) << "whole";
  EXPECT_EQ(frame(2), 0);
  EXPECT_FALSE(ran()) << "there is a result, and no checkpoint";
}

TEST_F(SlurmTask, RendersWithoutCheckpointsBeginAgain) {
  for (const char* options : {"--shutter 0,0.5", "--deep=d.exr"}) {
    EXPECT_EQ(frame(1, options), 0);
    const std::string arguments = bytes_of(path("arguments"));
    EXPECT_FALSE(contains(arguments, "--checkpoint")) << arguments;
    EXPECT_TRUE(contains(arguments, options)) << arguments;
  }
}

}  // namespace
}  // namespace dapple
