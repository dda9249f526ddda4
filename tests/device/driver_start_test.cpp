// OpenCL drivers that are missing or cannot work. Either the program renders nevertheless, or it
// ends with exit code 4 and a message about this cause. It never ends by a signal.
#include <gtest/gtest.h>

#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::has_namespaces;
using program_test::in_namespace;
using program_test::Outcome;

namespace fs = std::filesystem;

/// Tests that may use kernels from the kernel cache.
class DriverStart : public program_test::ProgramRun {
 protected:
  void expect_picture(const Outcome& run) const {
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(read_exr(path("out.exr")).width, 8);
    fs::remove(path("out.exr"));
  }
};

/// Tests that compile every kernel anew, which takes seconds.
class DriverStartCold : public DriverStart {};

TEST_F(DriverStart, NoPlatformAndNoSuchDeviceHaveDifferentMessages) {
  fs::create_directory(path("no_vendors"));
  const std::string no_icd = "OCL_ICD_VENDORS='" + path("no_vendors") + "'";
  expect_failure(render("", no_icd), 4, "no OpenCL platform found where OCL_ICD_VENDORS points");
  expect_failure(dapple("devices", no_icd), 4, "no OpenCL platform");
  expect_failure(render("", "OCL_ICD_VENDORS=/nonexistent"), 4, "no OpenCL platform");
  const Outcome other = render("--device nosuch");
  expect_failure(other, 4, "nosuch");
  EXPECT_TRUE(contains(other.err, "there are: '")) << other.err;
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(DriverStart, ADriverThatIsNotALibraryGivesNoPlatform) {
  fs::create_directory(path("vendors"));
  write_bytes(path("vendors/broken.icd"), path("broken.so") + "\n");
  write_bytes(path("broken.so"), "no library");
  expect_failure(render("", "OCL_ICD_VENDORS='" + path("vendors") + "'"), 4, "no OpenCL platform");
}

TEST_F(DriverStartCold, WithoutHomeKernelsAreCompiledElsewhere) {
  fs::create_directory(path("tmp"));
  const std::string nowhere = "env -u HOME -u XDG_CACHE_HOME -u POCL_CACHE_DIR ";
  expect_picture(render("", nowhere + "TMPDIR='" + path("tmp") + "'"));
  EXPECT_TRUE(fs::is_empty(path("tmp"))) << "nothing is kept where others could write";
}

TEST_F(DriverStartCold, RendersWithoutATemporaryFolder) {
  expect_picture(render("", "TMPDIR=/nonexistent POCL_CACHE_DIR=/dev/null/cache"));
}

TEST_F(DriverStartCold, ACacheThatCannotBeUsedIsIgnoredWithANote) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  fs::create_directory(path("cache"));
  const std::string with_cache = "POCL_CACHE_DIR='" + path("cache") + "' ";
  for (const char* options : {"ro", "noexec", "size=200k"}) {
    SCOPED_TRACE(options);
    const std::string mount = std::string("mount -t tmpfs -o ") + options + " none cache";
    const Outcome run = render("", with_cache + in_namespace(mount));
    EXPECT_TRUE(contains(run.err, "compiled kernels are not kept: " + path("cache"))) << run.err;
    expect_picture(run);
  }
}

// By another process, at any moment: PoCL reports an error, or LLVM ends the process.
TEST_F(DriverStartCold, ADiskThatIsFullBeforeKernelsAreCompiledIsNamed) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  fs::create_directory(path("cache"));
  const std::string mount =
      "mount -t tmpfs -o size=9m none cache && { (until ls -d cache/*/pocl; do sleep 0.01; done; "
      "dd "
      "if=/dev/zero of=cache/fill bs=1M) >/dev/null 2>&1 & true; }";
  const Outcome run = render("", "POCL_CACHE_DIR='" + path("cache") + "' " + in_namespace(mount));
  expect_failure(run, 4, " space ");
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

TEST_F(DriverStart, NoWritableFolderForKernelsIsAnError) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  // Makes /tmp read-only but keeps its content, since the program itself may be in /tmp.
  const std::string mount = "mount --rbind /tmp /tmp && mount -o remount,bind,ro /tmp";
  const std::string before = "HOME=/tmp/none TMPDIR=/tmp XDG_CACHE_HOME= POCL_CACHE_DIR= ";
  const Outcome run = dapple("devices", before + in_namespace(mount));
  expect_failure(run, 4, "PoCL has no folder to compile kernels in (/tmp/none/");
  EXPECT_TRUE(contains(run.err, "Read-only file system")) << run.err;
}

TEST_F(DriverStart, RendersInAReadOnlyWorkingFolder) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  fs::create_directories(path("work"));
  const std::string mount = "mount -t tmpfs -o ro none work && cd work";
  const Outcome run =
      dapple("render scene:cube -o ../out.exr --width 8 --height 8 --spp 1", in_namespace(mount));
  expect_picture(run);
}

TEST_F(DriverStart, WithoutSysPoclStillKnowsItsMemory) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  const std::string no_sys = in_namespace("mount -t tmpfs none /sys");
  expect_picture(render("", no_sys));
  const Outcome devices = dapple("devices", no_sys);
  EXPECT_EQ(devices.code, 0) << devices.err;
  EXPECT_TRUE(contains(devices.out, "GB")) << devices.out;
}

TEST_F(DriverStart, AKernelThatDoesNotCompileNamesFileAndLine) {
  write_bytes(path("kernels/film/compact.cl"), "int fine;\nthis is no OpenCL C\n");
  const Outcome run = render("--kernel-dir kernels");
  expect_failure(run, 4, "queue_kernels.cl: the OpenCL compiler of ");
  EXPECT_TRUE(contains(run.err, "compact.cl:2:")) << run.err;
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(DriverStartCold, PoclWithoutItsLinkerIsAMessageAtOnce) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  const std::string hide = "mount --bind /dev/null $(readlink -f /usr/bin/ld)";
  const Outcome run = render("", "POCL_CACHE_DIR='" + path("cache") + "' " + in_namespace(hide));
  expect_failure(run, 4, "PoCL links kernels with the program ld, which is not in PATH");
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

// PoCL aborts if it cannot link the code that it compiled: here its linker always fails.
TEST_F(DriverStartCold, ADriverThatAbortsIsAMessageNotASignal) {
  if (!has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  const std::string fail = "mount --bind $(readlink -f /bin/false) $(readlink -f /usr/bin/ld)";
  const Outcome run = render("", "POCL_CACHE_DIR='" + path("cache") + "' " + in_namespace(fail));
  expect_failure(run, 4, "the OpenCL driver crashed while ");
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

}  // namespace
}  // namespace dapple
