// farm/slurm/frames with a stub in place of sbatch, which writes its arguments to a file: the jobs
// that it asks for, and the frames, rates and names that it refuses before there is a job.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using film_test::bytes_of;
using film_test::contains;

class SlurmFrames : public film_test::FilmFile {
 protected:
  void SetUp() override {
    std::ofstream(path("sbatch")) << "#!/bin/sh\nprintf '%s\\n' \"$@\" > arguments; echo 77\n";
    std::filesystem::permissions(path("sbatch"), std::filesystem::perms::owner_all);
  }

  /// Runs frames with these arguments and a scene. Returns the exit code.
  [[nodiscard]] int frames(const std::string& arguments) const {
    std::filesystem::remove(path("arguments"));
    const std::string command = "cd '" + folder_.string() +
                                "' && PATH=\"$PWD:$PATH\" bash '" DAPPLE_SOURCE_FOLDER
                                "/farm/slurm/frames' " +
                                arguments + " tree.glb --spp 4 > out.txt 2> err.txt";
    return WEXITSTATUS(std::system(command.c_str()));
  }

  /// Expects that there is no job, and a line that begins with "frames: " and has `why`.
  void expect_refused(const std::string& arguments, const std::string& why) const {
    SCOPED_TRACE(arguments);
    EXPECT_EQ(frames(arguments), 2);
    const std::string message = bytes_of(path("err.txt"));
    EXPECT_TRUE(message.starts_with("frames: ")) << message;
    EXPECT_TRUE(contains(message, why)) << message;
    EXPECT_FALSE(std::filesystem::exists(path("arguments"))) << "a job is queued";
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << "a folder is made";
  }
};

TEST_F(SlurmFrames, AreTheTasksOfOneJob) {
  ASSERT_EQ(frames("8-10 23.976 out/w_%04d.exr"), 0) << bytes_of(path("err.txt"));
  EXPECT_EQ(bytes_of(path("out.txt")), "77\n");
  const std::string arguments = bytes_of(path("arguments"));
  EXPECT_TRUE(contains(arguments, "--array=0-2\n")) << arguments;
  EXPECT_TRUE(contains(arguments, "/task\nframe\n8/23.976\nout/w_%04d.exr\ntree.glb\n--spp\n4\n"))
      << arguments;
  EXPECT_TRUE(std::filesystem::is_directory(path("out")));
}

TEST_F(SlurmFrames, MayBeOneFrameAndHaveZerosBeforeTheirNumbers) {
  ASSERT_EQ(frames("008-010 24 w_%d.exr"), 0) << bytes_of(path("err.txt"));
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "--array=0-2\n"));
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "\n8/24\n"));
  ASSERT_EQ(frames("5-5 24 w_%d.exr"), 0) << bytes_of(path("err.txt"));
  EXPECT_TRUE(contains(bytes_of(path("arguments")), "--array=0-0\n"));
}

TEST_F(SlurmFrames, ThatEndBeforeTheyBeginAreRefused) {
  expect_refused("5-2 24 out/w_%04d.exr", "the last frame, 2, is before the first, 5");
  expect_refused("010-9 24 out/w_%04d.exr", "the last frame, 9, is before the first, 10");
}

TEST_F(SlurmFrames, OfARateThatIsNoNumberAboveZeroAreRefused) {
  for (const std::string fps : {"30000/1001", "0", "0.0", "-24", "abc", "1e3", "24fps", "''"})
    expect_refused("1-2 " + fps + " out/w_%04d.exr", "not a number above 0");
}

TEST_F(SlurmFrames, OfWhichTwoWouldHaveOneNameAreRefused) {
  for (const std::string out : {"out/w.####.exr", "out/w.exr", "'o 50% %04d.exr'"})
    expect_refused("1-2 24 " + out, "does not give each frame a name of its own");
  EXPECT_EQ(frames("1-2 24 'o 50%% %04d.exr'"), 0) << bytes_of(path("err.txt"));
}

}  // namespace
}  // namespace dapple
