// --resume-or-begin: goes on from a checkpoint that fits, and begins anew where it is missing,
// damaged or of another scene; other failures stay failures, and so does a file that cannot be
// read.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class ResumeOrBegin : public ProgramRun {
 protected:
  [[nodiscard]] Outcome resumed(const std::string& more = "",
                                const std::string& scene = "leaves=500") const {
    return dapple("render 'scene:tree?" + scene +
                  "' --width 16 --height 12 --spp 8 --report-bias 0 -o b.exr --checkpoint a.ckpt "
                  "--resume-or-begin a.ckpt " +
                  more);
  }

  /// Expects that a render from `checkpoint` fails in one line that names it, and leaves it there.
  void expect_unreadable(const std::string& checkpoint, const std::string& more = "",
                         const std::string& before = "") const {
    const Outcome run = dapple(
        "render 'scene:tree?leaves=500' --width 16 --height 12 --spp 8 -o c.exr "
        "--resume-or-begin " +
            checkpoint + " " + more,
        before);
    expect_failure(run, 1, "dapple: " + checkpoint + ": cannot be read: ");
    EXPECT_TRUE(run.err.starts_with("dapple: ")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("c.exr"))) << checkpoint;
    EXPECT_FALSE(std::filesystem::exists(path(checkpoint.substr(0, 99) + ".unfit"))) << checkpoint;
  }
};

TEST_F(ResumeOrBegin, GoesOnOrBeginsAnewWithTheSameBits) {
  const Outcome missing = resumed();
  EXPECT_EQ(missing.code, 0);
  EXPECT_TRUE(contains(missing.err, "note: begins anew, since a.ckpt is not there\n"))
      << missing.err;
  const std::string whole = bytes_of(path("b.exr"));
  const Outcome again = resumed();
  EXPECT_TRUE(contains(again.err, "went on from")) << again.err;
  EXPECT_FALSE(contains(again.err, "begins anew")) << again.err;
  EXPECT_TRUE(bytes_of(path("b.exr")) == whole);
  std::filesystem::resize_file(path("a.ckpt"), 1000);
  const Outcome damaged = resumed();
  EXPECT_EQ(damaged.code, 0);
  EXPECT_TRUE(contains(damaged.err,
                       "note: begins anew, keeps the checkpoint as a.ckpt.unfit, since --resume "
                       "a.ckpt: damaged"))
      << damaged.err;
  EXPECT_EQ(bytes_of(path("a.ckpt.unfit")).size(), 1000u);
  EXPECT_TRUE(bytes_of(path("b.exr")) == whole);
  const Outcome changed = resumed("", "leaves=400");
  EXPECT_EQ(changed.code, 0);
  EXPECT_TRUE(contains(changed.err, "since --resume a.ckpt: was made with")) << changed.err;
  EXPECT_FALSE(bytes_of(path("b.exr")) == whole);
  EXPECT_EQ(bytes_of(path("a.ckpt.unfit")).size(), 1000u) << "the first one is still there";
  EXPECT_TRUE(std::filesystem::exists(path("a.ckpt.unfit_2")));
}

TEST_F(ResumeOrBegin, ALinkThatLeadsNowhereIsNotThereAndQuietRendersDoNotSaySo) {
  std::filesystem::create_symlink("nowhere.ckpt", path("link.ckpt"));
  const std::string render =
      "render scene:cube?divisions=1 --width 8 --height 8 --spp 1 -o b.exr --resume-or-begin "
      "link.ckpt ";
  const Outcome run = dapple(render);
  EXPECT_EQ(run.code, 0);
  EXPECT_TRUE(contains(run.err, "note: begins anew, since link.ckpt is not there\n")) << run.err;
  EXPECT_EQ(dapple(render + "-q").err, "");
}

TEST_F(ResumeOrBegin, KeepsACheckpointOfAnotherSpelling) {
  ASSERT_EQ(resumed().code, 0);
  const std::string saved = bytes_of(path("a.ckpt"));
  const Outcome run = dapple(
      "render 'scene:tree?leaves=400' --width 16 --height 12 --spp 8 -o b.exr --checkpoint "
      "./a.ckpt --resume-or-begin a.ckpt");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(bytes_of(path("a.ckpt.unfit")) == saved);
}

TEST_F(ResumeOrBegin, KeepsWhatALinkLeadsTo) {
  ASSERT_EQ(resumed().code, 0);
  const std::string saved = bytes_of(path("a.ckpt"));
  std::filesystem::create_symlink("a.ckpt", path("link.ckpt"));
  const std::string render =
      "render 'scene:tree?leaves=400' --width 16 --height 12 --spp 8 -o b.exr --checkpoint "
      "link.ckpt --resume-or-begin a.ckpt";
  const Outcome run = dapple(render);
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(bytes_of(path("a.ckpt.unfit")) == saved);
  EXPECT_FALSE(std::filesystem::is_symlink(path("a.ckpt.unfit")));
}

TEST_F(ResumeOrBegin, OtherFailuresLeaveTheCheckpoint) {
  ASSERT_EQ(resumed().code, 0);
  const std::string saved = bytes_of(path("a.ckpt"));
  expect_failure(resumed("--device nothing"), 4, "nothing");
  expect_failure(resumed("--frames 1-2"), 2, "--frames");
  expect_failure(resumed("--resume a.ckpt"), 2, "--resume");
  EXPECT_TRUE(bytes_of(path("a.ckpt")) == saved);
}

TEST_F(ResumeOrBegin, ACheckpointThatCannotBeReadIsNamedAndNothingBegins) {
  std::filesystem::create_symlink("loop.ckpt", path("loop.ckpt"));
  expect_unreadable("loop.ckpt");
  std::filesystem::create_directory(path("folder.ckpt"));
  expect_unreadable("folder.ckpt");
  expect_unreadable(std::string(256, 'n'));  // a file's name has at most 255 characters
}

/// Shell code with which the program runs as a user that is not root, who may read everything.
/// Empty: there is no such user here.
std::string as_a_user() {
  if (geteuid() != 0) return "env";
  const std::string user = "setpriv --reuid=65534 --regid=65534 --clear-groups";
  const std::string probe = user + " '" DAPPLE_PROGRAM "' --version >/dev/null 2>&1";
  return std::system(probe.c_str()) == 0 ? user : "";
}

TEST_F(ResumeOrBegin, ACheckpointWithoutPermissionsIsNamedAndStays) {
  const std::string user = as_a_user();
  if (user.empty()) GTEST_SKIP() << "root is the only user";
  using std::filesystem::perms;
  ASSERT_EQ(resumed().code, 0);
  const std::string saved = bytes_of(path("a.ckpt"));
  std::filesystem::permissions(folder_, perms::all);
  std::filesystem::create_directory(path("locked"));
  std::filesystem::copy(path("a.ckpt"), path("locked/a.ckpt"));
  std::filesystem::permissions(path("locked"), perms::none);
  expect_unreadable("locked/a.ckpt", "", user);
  std::filesystem::permissions(path("locked"), perms::owner_all);
  std::filesystem::permissions(path("a.ckpt"), perms::none);
  expect_unreadable("a.ckpt", "", user);
  // The new checkpoint would replace it: it is written to, and cannot be read.
  std::filesystem::permissions(path("a.ckpt"),
                               perms::owner_write | perms::group_write | perms::others_write);
  expect_unreadable("a.ckpt", "--checkpoint a.ckpt", user);
  std::filesystem::permissions(path("a.ckpt"), perms::owner_all);
  EXPECT_TRUE(bytes_of(path("a.ckpt")) == saved);
}

}  // namespace
}  // namespace dapple
