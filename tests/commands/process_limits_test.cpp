// The program where the process may do little: few files, small stacks, no PATH, no time, no
// standard error. It says which limit, or is right all the same.
#include <gtest/gtest.h>

#include "support/programs/processor_time.hpp"
#include "support/programs/program_run.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class ProcessLimits : public ProgramRun {};

TEST_F(ProcessLimits, OfFilesStacksAndMemoryAreNamed) {
  DAPPLE_SKIP_WITH_SANITIZER();
  expect_failure(render("", "bash -c 'ulimit -n 5; exec \"$0\" \"$@\"'"), 1,
                 "only 5 files may be open here (ulimit -n)");
  expect_failure(render("", "ulimit -s 64;"), 1, "stacks may only have 64 kB here (ulimit -s)");
  // With less, arguments could not even be read; the dynamic linker needs up to 16 kB.
  for (const char* stack : {"20", "24", "40"})
    expect_failure(render("", std::string("ulimit -s ") + stack + ";"), 1,
                   "stacks may only have less than 64 kB here (ulimit -s)");
  expect_failure(render("", "ulimit -v 200000;"), 1,
                 "only have 200000 kB of memory here (ulimit -v)");
  expect_failure(render("", "ulimit -d 200000;"), 1,
                 "only have 200000 kB of memory here (ulimit -d)");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(ProcessLimits, WithoutALinkerInPathItSaysSoBeforeItCompiles) {
  const std::string empty_cache = "export XDG_CACHE_HOME=" + path("cache") + "; mkdir -p cache; ";
  for (const char* before : {"PATH=; export PATH; ", "unset PATH; "}) {
    const double start = processor_seconds_of_children();
    expect_failure(render("", empty_cache + before), 4,
                   "PoCL links kernels with the program ld, which is not in PATH");
    EXPECT_LT(processor_seconds_of_children() - start, 4);
  }
}

TEST_F(ProcessLimits, AClosedStandardErrorDoesNotSpoilThePicture) {
  const Outcome run = render("", "sh -c 'exec \"$0\" \"$@\" 2>&-'");
  EXPECT_EQ(run.code, 0);
  EXPECT_TRUE(contains(run.out, "wrote out.exr")) << run.out;
  EXPECT_EQ(read_exr(path("out.exr")).width, 8);
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(ProcessLimits, ADaemonWithNothingOpenIsDoneWhenItsPictureIs) {
  EXPECT_EQ(render("", "sh -c 'exec \"$0\" \"$@\" <&- >&- 2>&-'").code, 0);
  EXPECT_EQ(read_exr(path("out.exr")).width, 8);
  const Outcome run = render("", "sh -c 'exec \"$0\" \"$@\" >&-'");
  EXPECT_EQ(run.code, 1);
  EXPECT_TRUE(contains(run.err, "cannot write to the standard output")) << run.err;
}

TEST_F(ProcessLimits, ALostReaderOfMuchTextDoesNotHideTheResult) {
  ASSERT_EQ(render("", "").code, 0);
  ASSERT_EQ(dapple("render 'scene:tree?leaves=200' --width 8 --height 8 --spp 1 -q -o b.exr").code,
            0);
  const std::string lost = "bash -c '\"$0\" \"$@\" | true; exit ${PIPESTATUS[0]}'";
  EXPECT_EQ(dapple("compare out.exr b.exr --max-rmse 0 --json", lost).code, 5);
  EXPECT_EQ(dapple("render 'scene:tree?leaves=20' --width 8 --height 8 --spp 1 --frames 1-3 "
                   "-o f.#.exr",
                   "bash -c 'stdbuf -oL \"$0\" \"$@\" | true; exit ${PIPESTATUS[0]}'")
                .code,
            0);
  EXPECT_EQ(read_exr(path("f.3.exr")).width, 8);
}

TEST_F(ProcessLimits, ALostReaderDoesNotStopTheWork) {
  for (const char* lost : {"2>&1", "2>/dev/null"}) {
    const Outcome run = render(
        "", std::string("bash -c '\"$0\" \"$@\" ") + lost + " | true; exit ${PIPESTATUS[0]}'");
    EXPECT_EQ(run.code, 0) << lost << run.err;
    EXPECT_EQ(read_exr(path("out.exr")).width, 8) << lost;
    EXPECT_EQ(files_in_folder(), 1u);
  }
}

TEST_F(ProcessLimits, AMissingTemporaryFolderIsNamedAndRendersDoNotNeedIt) {
  const std::string missing = "TMPDIR=" + path("missing");
  EXPECT_EQ(render("", missing).code, 0);
  expect_failure(
      dapple("plan 'scene:tree?leaves=2000' --spp 4", missing), 1,
      "cannot make a folder in " + path("missing") + " (TMPDIR, or else /tmp): No such file");
  const std::string errors = path("errors");
  const std::string setup =
      missing + " timeout 300 " DAPPLE_SOURCE_FOLDER "/setup test 2>" + errors;
  EXPECT_EQ(WEXITSTATUS(std::system(setup.c_str())), 1);
  EXPECT_EQ(bytes_of(errors), "setup: the tests need a folder for their files: " + path("missing") +
                                  " (TMPDIR, or else /tmp) is missing or not writable\n");
}

// At a soft limit the kernel sends SIGXCPU. At a hard one it sends SIGKILL, which nothing survives:
// the program stops before it.
TEST_F(ProcessLimits, OfProcessorTimeSaveACheckpoint) {
  for (const char* limit : {"ulimit -S -t 4", "ulimit -t 6"}) {
    SCOPED_TRACE(limit);
    std::filesystem::remove(path("a.ckpt"));
    const Outcome run = dapple(
        "render 'scene:tree?leaves=2000' --width 96 --height 80 --spp 1048576 -o out.exr "
        "--checkpoint a.ckpt --checkpoint-every 1h",
        std::string(limit) + "; exec env");
    EXPECT_EQ(run.code, -1) << "128 + SIGXCPU";
    EXPECT_TRUE(contains(run.err, "--resume a.ckpt goes on")) << run.err;
    EXPECT_TRUE(std::filesystem::exists(path("a.ckpt")));
  }
}

TEST_F(ProcessLimits, WithAnEmptyEnvironmentItSaysWhatIsMissing) {
  DAPPLE_SKIP_WITH_SANITIZER();  // its options are in the environment
  expect_failure(render("", "env -i"), 4,
                 "PoCL links kernels with the program ld, which is not in PATH (not set); add its "
                 "folder, for example /usr/bin");
  EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
  for (const char* command : {"points 'scene:tree?leaves=200' --grid=0,0,1,1,1 -o out.csv",
                              "bake 'scene:tree?leaves=200' -o out.glb"})
    expect_failure(dapple(command, "env -i"), 4, "PoCL links kernels with the program ld");
  const Outcome devices = dapple("devices", "env -i");
  EXPECT_EQ(devices.code, 0) << devices.err;
  expect_failure(dapple("render", "env -i"), 2, "SCENE is missing");
}

TEST_F(ProcessLimits, TheCommandLineSaysWhatItExpects) {
  const std::pair<const char*, const char*> cases[] = {
      {"render x.glb -o o.exr --seed -1",
       "--seed -1: expected a whole number from 0 to 4294967295; dapple render --help"},
      {"render x.glb -o o.exr --spp 1 --spp 2", "--spp is given more than once"},
      {"render x.glb -o o.exr --spp", "--spp needs a value"},
      {"render x.glb -o o.exr --spp many",
       "--spp many: expected a whole number from 1 to 1048576; dapple"},
      {"render x.glb -o o.exr --spp 99999999999",
       "99999999999: expected a whole number from 1 to 1048576; dapple"},
      {"render x.glb -o o.exr --spp 0", "--spp is 0; it must be from 1 to 1048576"},
      {"render x.glb -o o.png", "--output is o.png, but images are OpenEXR files"},
      {"render x.glb -o o.exr --passes back", "back is the other side of ao or light"},
      {"render x.glb -o o.exr --dome-rotation 3", "--dome-rotation needs --dome"},
      {"render x.glb -o o.exr --max-spp 8", "--max-spp needs --target-rmse or --target-error"},
      {"render x.glb -o o.exr --passes ao --light-rays 2", "--light-rays needs the pass light"},
      {"render x.glb -o o.exr --passes ao --lights l.json",
       "--lights needs the pass light or beau"},
      {"render x.glb -o o.exr --passes ao --dome d.exr", "--dome needs the pass light or beauty"},
      {"render x.glb -o o.exr --passes light --ao-distance 2", "--ao-distance needs the pass ao"},
      {"render x.glb -o o.exr --back-every 4", "--back-every needs the pass back"},
      {"render x.glb -o o.exr --half aoo",
       "--half aoo: there is no such layer; there are all, RGBA"},
      {"render x.glb -o o.exr --roulette 0.5", "--roulette needs --estimator exact"},
      {"render x.glb -o o.json", "--output is o.json, but images are OpenEXR files"},
      {"merge x.dapple -o o.png", "--output is o.png, but images are OpenEXR files"},
      {"render x.glb -o o.exr --png p.jpg", "--png is p.jpg, but previews are PNG files"},
      {"bake x.glb -o o.glb --png p.jpg", "--png is p.jpg, but previews are PNG files"},
      {"compare x.exr y.exr --png p.jpg", "--png is p.jpg, but previews are PNG files"},
      {"render x.glb -o o.exr --crop 0,0,3.5,2", "'3.5' is not a whole number"},
      {"render x.glb -o o.exr --exposure 1", "--exposure needs --png"},
      {"render x.glb -o o.exr --background none", "--background needs --png"},
      {"merge x.dapple -o o.exr --exposure 1", "--exposure needs --png"},
      {"points scene:tree --grid 0,1,0,1,1 -o o.csv --sky-irradiance 2",
       "--sky-irradiance needs --sky uniform or overcast"},
      {"render x.glb -o o.exr --deep d.png", "--deep is d.png, but images are OpenEXR files"},
      {"render x.glb -o o.exr --deep ''", "--deep: needs a value, its value is empty"},
      {"render x.glb -o o.exr --cryptomatte=", "--cryptomatte: needs a value, its value is empty"},
      {"render x.glb -o o.exr --exposure= --width 16", "--exposure: needs a value"},
      {"render x.glb -o o.exr --frame 1 --shutter 0,1 --motion-samples 0",
       "--motion-samples is 0; it must be from 1 to 1024"},
      {"render x.glb -o o.exr --png p.png --background 0,0", "expected R,G,B"},
      {"render scene:cube -o o.exr --kernel-dir missing", "missing: there is no such folder"},
      {"plan scene:cube --spp 4 --deep d.exr", "dapple plan knows no deep files"},
      {"render x.glb -o o.exr --background blue", "--background blue: it is sky, none or R,G,B"},
      {"bake x.glb -o o.glb --ao-falloff 2", "--ao-falloff needs --ao-distance"},
      {"points x.glb -o o.csv --grid 0,0,1,1", "--grid has 4 numbers; it needs 5"},
      {"points scene:cube -o o.csv --grid 0,0,1,1,1 --sky pink", "it must be uniform, overcast or"},
      {"render x.glb -o o.exr --footprint x", "--footprint x: expected a number"},
      {"render x.glb", "--output is missing"},
      {"render -o o.exr", "SCENE is missing"},
      {"render x.glb -o o.exr --sp 3", "there is no option --sp"},
      {"render x.glb y.glb -o o.exr", "'y.glb' is an argument too many"},
      {"render x.glb -o o.exr --checkpoint-every 5s", "--checkpoint-every needs --checkpoint"},
      {"render x.glb -o o.#.exr --frame 1 --frames 1-2", " does not go with "},
      {"rendr x.glb", "there is no command rendr; dapple --help"},
      {"", "a subcommand is needed"},
  };
  for (const auto& [arguments, text] : cases) {
    const Outcome run = dapple(arguments);
    expect_failure(run, 2, text);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

}  // namespace
}  // namespace dapple
