// farm/slurm/task with stubs in place of Slurm's programs. That of srun writes its arguments to a
// file, and fails as it is told, or runs the program: what the task runs at a first start and after
// a restart, with which frames per second, and when it queues itself again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using film_test::bytes_of;
using film_test::contains;

class SlurmTask : public film_test::FilmFile {
 protected:
  void SetUp() override {
    stub("srun", "echo \"$@\" > arguments; exit ${CODE:-0}");
    stub("scontrol", "echo \"$@\" >> queued");
    stub("sleep", ":");
  }

  void stub(const std::string& program, const std::string& does) const {
    std::ofstream(path(program)) << "#!/bin/sh\n" << does << "\n";
    std::filesystem::permissions(path(program), std::filesystem::perms::owner_all);
  }

  /// Runs frame 3 of a sequence, which begins with frame `first`. Returns the exit code.
  [[nodiscard]] int frame(int restarts, const std::string& options = "", int first = 1,
                          const std::string& fps = "24") const {
    const std::string command =
        "cd '" + folder_.string() + "' && PATH=\"$PWD:$PATH\" " +
        "SLURM_JOB_ID=77 SLURM_ARRAY_TASK_ID=" + std::to_string(3 - first) +
        " CODE=" + std::to_string(srun_code_) +
        " DAPPLE='" DAPPLE_PROGRAM "' SLURM_CPUS_PER_TASK=8 SLURM_RESTART_COUNT=" +
        std::to_string(restarts) + " bash '" DAPPLE_SOURCE_FOLDER "/farm/slurm/task' frame " +
        std::to_string(first) + "/" + fps + " f_%04d.exr 'scene:tree?leaves=200&wind=1' " + options;
    return WEXITSTATUS(std::system(command.c_str()));
  }
  [[nodiscard]] bool ran() const { return std::filesystem::exists(path("arguments")); }

  /// What the task asks of scontrol when srun ends with `code` after so many restarts. A checkpoint
  /// is there. Expects that the task ends with the same code.
  [[nodiscard]] std::string queued_after(int code, int restarts) {
    std::ofstream(path("f_0003.exr.ckpt")) << "state";
    std::filesystem::remove(path("queued"));
    srun_code_ = code;
    EXPECT_EQ(frame(restarts), code);
    return bytes_of(path("queued"));
  }

  int srun_code_ = 0;  ///< with which the stub of srun ends
};

TEST_F(SlurmTask, AFirstStartRemovesWhatAnEarlierJobLeft) {
  for (const char* name : {"f_0003.exr", "f_0003.exr.ckpt"}) std::ofstream(path(name)) << "old";
  EXPECT_EQ(frame(0), 0);
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr")));
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr.ckpt")));
  const std::string arguments = bytes_of(path("arguments"));
  EXPECT_TRUE(contains(arguments, "--frame 0.125 --fps 24 -o f_0003.exr")) << arguments;
  EXPECT_TRUE(contains(arguments, "--checkpoint f_0003.exr.ckpt")) << arguments;
  EXPECT_FALSE(contains(arguments, "--resume")) << arguments;
  EXPECT_TRUE(contains(arguments, "--ntasks=1 --cpus-per-task=8 ")) << arguments;
  EXPECT_EQ(frame(0, "", 3), 0);
  EXPECT_EQ(bytes_of(path("arguments")), arguments);
}

TEST_F(SlurmTask, ARestartGoesOnFromItsCheckpointOrBeginsAgainAndLeavesNoOldPicture) {
  for (const char* name : {"f_0003.exr", "f_0003.exr.ckpt"}) std::ofstream(path(name)) << "old";
  EXPECT_EQ(frame(1), 0);
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "--resume-or-begin f_0003.exr.ckpt"));
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr")));
  std::filesystem::remove(path("arguments"));
  std::ofstream(path("f_0003.exr")) << "of an earlier job";
  EXPECT_EQ(frame(2), 0);
  EXPECT_TRUE(ran()) << "there is no checkpoint, and the picture may be another job's";
  EXPECT_FALSE(contains(bytes_of(path("arguments")), "--resume"));
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr")));
}

TEST_F(SlurmTask, RendersWithoutCheckpointsBeginAgain) {
  for (const char* options : {"--shutter 0,0.5", "--deep=d.exr"}) {
    std::ofstream(path("f_0003.exr")) << "of a part of the samples";
    EXPECT_EQ(frame(1, options), 0);
    EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr"))) << options;
    const std::string arguments = bytes_of(path("arguments"));
    EXPECT_FALSE(contains(arguments, "--checkpoint")) << arguments;
    EXPECT_TRUE(contains(arguments, options)) << arguments;
  }
}

TEST_F(SlurmTask, ASignalQueuesTheTaskAgainAtMostTenTimes) {
  EXPECT_EQ(queued_after(143, 0), "requeue 77\n") << "SIGTERM";
  EXPECT_EQ(queued_after(137, 9), "requeue 77\n") << "SIGKILL, and the tenth time";
  EXPECT_EQ(queued_after(143, 10), "");
}

TEST_F(SlurmTask, OtherFailuresAreFinal) {
  for (const int code : {1, 2, 3, 4}) {
    EXPECT_EQ(queued_after(code, 0), "") << code;
    EXPECT_EQ(queued_after(code, 1), "") << code;
  }
}

TEST_F(SlurmTask, TheCheckpointIsRemovedOnceTheFrameIsWhole) {
  EXPECT_EQ(queued_after(143, 1), "requeue 77\n");
  EXPECT_TRUE(std::filesystem::exists(path("f_0003.exr.ckpt")));
  EXPECT_EQ(queued_after(0, 1), "");
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "--resume-or-begin f_0003.exr.ckpt"));
  EXPECT_FALSE(std::filesystem::exists(path("f_0003.exr.ckpt")));
}

TEST_F(SlurmTask, TheFramesPerSecondArePassedOnceThoseOfTheOptionsFirst) {
  EXPECT_EQ(frame(0, "--spp 4"), 0);
  EXPECT_TRUE(contains(bytes_of(path("arguments")), " --frame 0.125 --fps 24 "))
      << bytes_of(path("arguments"));
  for (const char* options : {"--fps 12 --spp 4", "--spp 4 --fps=12"}) {
    EXPECT_EQ(frame(0, options), 0);
    const std::string arguments = bytes_of(path("arguments"));
    EXPECT_TRUE(contains(arguments, options)) << arguments;
    EXPECT_EQ(arguments.find("--fps"), arguments.rfind("--fps")) << arguments;
  }
}

TEST_F(SlurmTask, MotionVectorsAreThoseOfTheSequence) {
  const std::string options = "--passes motion --width 24 --height 16 --spp 4 -q";
  stub("srun", "while [ \"${1#--}\" != \"$1\" ]; do shift; done; exec \"$@\"");
  ASSERT_EQ(frame(0, options, 1, "30"), 0);
  const std::string sequence = "cd '" + folder_.string() +
                               "' && '" DAPPLE_PROGRAM
                               "' render 'scene:tree?leaves=200&wind=1' --frames 3-3 --fps 30 -o "
                               "s_####.exr " +
                               options;
  ASSERT_EQ(std::system(sequence.c_str()), 0);
  const Film task = read_exr(path("f_0003.exr")), whole = read_exr(path("s_0003.exr"));
  for (const char* channel : {"motion.X", "motion.Y"}) {
    const std::vector<float>& vectors = task.find(channel)->pixels;
    EXPECT_EQ(vectors, whole.find(channel)->pixels) << channel;
    EXPECT_GT(*std::max_element(vectors.begin(), vectors.end()), 0) << "something moves";
  }
}

}  // namespace
}  // namespace dapple
