// The program with limits of memory and disk, and killed at various moments: it writes the picture
// or prints a clear error, the output file is the former or the new one, and no other file remains.
// Slow: every step is a process.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/programs/program_run.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::has_namespaces;
using program_test::in_namespace;
using program_test::Outcome;

namespace fs = std::filesystem;

class Limits : public program_test::ProgramRun {
 protected:
  /// Returns whether it is the picture, which must be so wide.
  bool expect_picture_or_error(const Outcome& run, int width) const {
    EXPECT_TRUE(run.code == 0 || run.code == 1 || run.code == 4) << run.code << run.err;
    EXPECT_EQ(fs::exists(path("out.exr")), run.code == 0);
    EXPECT_EQ(files_in_folder(), run.code == 0 ? 1u : 0u) << run.err;
    if (run.code != 0) {
      EXPECT_TRUE(contains(run.err, "dapple: ")) << run.err;
    } else {
      EXPECT_EQ(read_exr(path("out.exr")).width, width);
    }
    fs::remove(path("out.exr"));
    return run.code == 0;
  }
};

TEST_F(Limits, TwentyStepsOfAddressSpaceGiveThePictureOrAnError) {
  DAPPLE_SKIP_WITH_SANITIZER();
  int pictures = 0;
  for (int step = 0; step < 20; ++step) {
    const int kilobytes = 800'000 + step * 168'000;
    SCOPED_TRACE(kilobytes);
    const Outcome run =
        dapple("render 'scene:tree?leaves=150000' -o out.exr --width 900 --height 700 --spp 1 -q",
               "ulimit -v " + std::to_string(kilobytes) + " && timeout 600");
    pictures += expect_picture_or_error(run, 900) ? 1 : 0;
  }
  EXPECT_GT(pictures, 0) << "the last step is 4 GB";
}

TEST_F(Limits, FileSizesFromNothingUpGiveThePictureOrAnErrorAndKeepTheFormerFile) {
  for (const int blocks : {0, 1, 100, 1000, 4096, 5000, 8000, 100'000}) {
    SCOPED_TRACE(blocks);
    write_bytes(path("out.exr"), "former");
    const Outcome run = dapple("render scene:cube -o out.exr --width 640 --height 400 --spp 1 -q",
                               "ulimit -f " + std::to_string(blocks) + " &&");
    EXPECT_EQ(files_in_folder(), 1u);
    if (run.code == 0) {
      EXPECT_EQ(read_exr(path("out.exr")).width, 640);
      continue;
    }
    EXPECT_EQ(run.code, 1) << run.err;
    if (blocks > 0) {  // with 0, the message cannot be written either
      EXPECT_TRUE(contains(run.err, "dapple: ")) << run.err;
    }
    EXPECT_EQ(bytes_of(path("out.exr")), "former");
    EXPECT_LT(blocks, 100'000);
  }
}

TEST_F(Limits, AFullDiskIsAnErrorThatKeepsTheFormerFile) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  fs::create_directory(path("disk"));
  const std::string mount = "mount -t tmpfs -o size=300k none disk && echo former > disk/out.exr";
  const std::string look = " ; code=\\$?; ls -A disk; cat disk/out.exr; exit \\$code";
  const Outcome run = dapple(
      "render scene:cube -o disk/out.exr --width 640 --height 400 --spp 1 -q' " + look + "\"",
      "unshare --user --map-root-user --mount sh -c \"" + mount + " && sh -c '");
  EXPECT_EQ(run.code, 1) << run.err;
  EXPECT_TRUE(contains(run.err, "cannot write disk/out.exr: No space left on device")) << run.err;
  EXPECT_EQ(run.out, "out.exr\nformer\n");
}

TEST_F(Limits, UnwritableMessagesDoNotCauseASignal) {
  // The '#' makes a comment of the redirections that dapple() appends.
  EXPECT_EQ(dapple("render nosuch.glb -o out.exr 2>/dev/full #").code, 3);
  const std::string err = " 2>'" + (logs() / "err").string() + "' #";
  expect_failure(dapple("info scene:cube >/dev/full" + err), 1,
                 "cannot write to the standard output: No space left on device");
}

TEST_F(Limits, KilledAtAnyMomentTheFileIsTheFormerOrTheNewAndTheNextRunSucceeds) {
  const std::string command = "render scene:cube -o out.exr --width 200 --height 200 --spp 1 -q";
  ASSERT_EQ(dapple(command).code, 0);
  const std::string whole = bytes_of(path("out.exr"));
  int killed = 0;
  for (int ms = 5; ms <= 400; ms += 15) {
    SCOPED_TRACE(ms);
    write_bytes(path("out.exr"), "former");
    // --foreground: else `timeout` would kill itself too, and not wait until the program is gone.
    const Outcome run =
        dapple(command, "timeout --foreground -s KILL " + std::to_string(ms / 1000.0));
    killed += run.code != 0;
    const std::string left = bytes_of(path("out.exr"));
    EXPECT_TRUE(left == "former" || left == whole) << left.size() << " bytes";
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(dapple(command).code, 0);
  EXPECT_TRUE(bytes_of(path("out.exr")) == whole);
  EXPECT_EQ(files_in_folder(), 1u) << "the last run cleaned up";
}

}  // namespace
}  // namespace dapple
