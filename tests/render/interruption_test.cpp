// Signals end renders of the program: exit codes, a complete picture and checkpoint file, and a
// next run that continues to the same file. A process that is killed loses only the work since its
// last checkpoint.
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "render/partial/checkpoint.hpp"
#include "support/files/film_files.hpp"
#include "support/programs/hanging_program.hpp"
#include "support/programs/processor_time.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;
using std::chrono::steady_clock;

// So many samples a pixel (2^20) that a render never ends during a test.
constexpr int kEndless = 1 << 20;

/// A copy of the kernels in which slices of pixels that have 1024 samples never end: tens of
/// slices, so that a checkpoint is due on a fast machine, too.
void copy_kernels_that_hang(const std::filesystem::path& to) {
  std::filesystem::copy(DAPPLE_SOURCE_FOLDER "/kernels", to,
                        std::filesystem::copy_options::recursive);
  const std::string file = to / "film/film.cl", first = "  long8 of_points = (long8)(0);\n";
  std::string text = bytes_of(file);
  ASSERT_TRUE(contains(text, first));
  text.insert(text.find(first),
              "  if (work[params.slice.first_work].first_sample >= 1024u)\n"
              "    for (volatile uint i = 1u; i; i = 1u) {}\n");
  write_bytes(file, text);
}

class Interruption : public FilmFile {
 protected:
  ~Interruption() override { std::filesystem::remove(log()); }

  [[nodiscard]] std::vector<std::string> render(int spp, std::vector<std::string> more) const {
    std::vector<std::string> arguments{"render",   "scene:tree?leaves=2000",
                                       "-o",       path("out.exr"),
                                       "--width",  "96",
                                       "--height", "80",
                                       "--spp",    std::to_string(spp)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] std::vector<std::string> with_checkpoint(int spp, const std::string& every) const {
    return render(spp, {"--checkpoint", path("a.ckpt"), "--checkpoint-every", every});
  }
  int run(std::vector<std::string> arguments, const std::string& more = "",
          const std::string& value = "") const {
    if (!more.empty()) arguments.insert(arguments.end(), {more, value});
    return RunningProgram(arguments, log()).wait();
  }
  /// Path of the log, outside of the folder, so that files_in_folder() does not count it.
  [[nodiscard]] std::string log() const { return folder_.string() + ".log"; }
  [[nodiscard]] bool is_there(const char* name) const {
    return std::filesystem::exists(path(name));
  }

  /// Starts a render whose driver hangs, and waits until it does: a slice takes hundredths of a
  /// second, and no checkpoint was written for so long that it ended on a busy machine, too.
  [[nodiscard]] std::unique_ptr<RunningProgram> render_that_hangs() const {
    const std::filesystem::path kernels = folder_ / "kernels";
    copy_kernels_that_hang(kernels);
    std::vector<std::string> arguments = with_checkpoint(kEndless, "0.02");
    arguments.insert(arguments.end(), {"--kernel-dir", kernels.string()});
    auto program = std::make_unique<RunningProgram>(arguments, log());
    EXPECT_TRUE(wait_until([&] { return is_there("a.ckpt") || program->has_ended(); }, kLongest));
    if (program->has_ended()) return program;
    auto last = saved_at();
    auto since = steady_clock::now();
    const auto hangs = [&] {
      if (saved_at() != last) {
        last = saved_at();
        since = steady_clock::now();
      }
      return steady_clock::now() - since > Milliseconds(2'500);
    };
    EXPECT_TRUE(wait_until([&] { return hangs() || program->has_ended(); }, kLongest));
    return program;
  }
  [[nodiscard]] std::filesystem::file_time_type saved_at() const {
    return std::filesystem::last_write_time(path("a.ckpt"));
  }
};

TEST_F(Interruption, ASignalEndsWithItsCodeAPictureAndACheckpointThatGoesOn) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}, {SIGXCPU, 152}}) {
    std::filesystem::remove(path("a.ckpt"));
    std::filesystem::remove(path("out.exr"));
    RunningProgram program(with_checkpoint(kEndless, "0.05"), log());
    ASSERT_TRUE(wait_until([&] { return is_there("a.ckpt"); }, kLongest)) << bytes_of(log());
    const auto sent = steady_clock::now();
    program.send(signal);
    EXPECT_EQ(program.wait(), code) << bytes_of(log());
    // A small picture needs tenths of a second; the limit allows for a busy machine. A program that
    // did not stop would be ended after 20 s, without a picture.
    const auto took = steady_clock::now() - sent;
    EXPECT_LT(took, Milliseconds(15'000));
    const std::string said = bytes_of(log());
    EXPECT_TRUE(contains(said, "interrupted after ")) << said;
    EXPECT_TRUE(contains(said, "--resume " + path("a.ckpt") + " goes on")) << said;
    if (signal != SIGINT && contains(said, "not written, to end soon")) {
      EXPECT_GT(took, Milliseconds(800)) << "a busy machine";
      EXPECT_EQ(files_in_folder(), 1u);
      continue;
    }
    const Film film = read_exr(path("out.exr"));
    const auto& samples = film.find("samples")->pixels;
    // The first pass: sixteen samples a pixel, two of which share a camera ray.
    EXPECT_GE(*std::min_element(samples.begin(), samples.end()), 8);
    EXPECT_EQ(files_in_folder(), 2u);
  }
  // A resumed run saves once it has more samples.
  const auto before = saved_at();
  std::vector<std::string> more = with_checkpoint(kEndless, "0.05");
  more.insert(more.end(), {"--resume", path("a.ckpt"), "-q"});
  RunningProgram again(more, log());
  EXPECT_TRUE(wait_until([&] { return saved_at() != before || again.has_ended(); }, kLongest));
  EXPECT_FALSE(again.has_ended()) << bytes_of(log());
  EXPECT_NE(saved_at(), before);
}

TEST_F(Interruption, AHangingDriverIsLeftTwoSecondsAfterSIGTERMWithTheLastCheckpoint) {
  const auto program = render_that_hangs();
  ASSERT_FALSE(program->has_ended()) << bytes_of(log());
  expect_end_in_two_seconds(*program, log());
  EXPECT_FALSE(is_there("out.exr"));
  // The checkpoint is whole: nothing is wrong with it but that it was made with these kernels.
  EXPECT_EQ(run(render(kEndless, {"--resume", path("a.ckpt")})), 2);
  EXPECT_TRUE(contains(bytes_of(log()), "differs from this run in kernels")) << bytes_of(log());
}

// The program stands still while it has a slice to end or something to save, as on a machine that
// is very busy.
TEST_F(Interruption, WhereTheMachineIsBusyTheLastCheckpointIsKept) {
  bool kept = false;
  for (int side = 400; side <= 3200 && !kept; side *= 2) {
    std::vector<std::string> arguments = with_checkpoint(kEndless, "0.3");
    arguments[5] = arguments[7] = std::to_string(side);
    std::filesystem::remove(path("a.ckpt"));
    std::filesystem::remove(path("out.exr"));
    RunningProgram program(arguments, log());
    ASSERT_TRUE(wait_until([&] { return is_there("a.ckpt"); }, kLongest)) << bytes_of(log());
    program.send(SIGTERM);
    std::this_thread::sleep_for(Milliseconds(1));
    program.send(SIGSTOP);
    std::this_thread::sleep_for(Milliseconds(1'100));
    program.send(SIGCONT);
    EXPECT_EQ(program.wait(), 143) << bytes_of(log());
    kept = contains(bytes_of(log()),
                    "dapple: ended before the samples since the last checkpoint were saved\n");
  }
  EXPECT_TRUE(kept) << bytes_of(log());
  EXPECT_FALSE(is_there("out.exr"));
  EXPECT_GT(read_checkpoint(path("a.ckpt")).state.samples.size(), 0u);
}

// The program stands still for a second after the signal, as on a machine that is very busy. It may
// have ended before; then the next try has a larger picture.
TEST_F(Interruption, WhereSavingTakesLongThereIsACheckpointAndNoPicture) {
  bool late = false;
  int delay = 2'000;
  for (int side = 400; side <= 3200 && !late; side *= 2, delay *= 2) {
    std::vector<std::string> arguments = with_checkpoint(kEndless, "1h");
    arguments[5] = arguments[7] = std::to_string(side);
    std::filesystem::remove(path("out.exr"));
    std::filesystem::remove(path("a.ckpt"));
    RunningProgram program(arguments, log());
    std::this_thread::sleep_for(Milliseconds(delay));
    program.send(SIGTERM);
    std::this_thread::sleep_for(Milliseconds(4));
    program.send(SIGSTOP);
    std::this_thread::sleep_for(Milliseconds(1'000));
    program.send(SIGCONT);
    EXPECT_EQ(program.wait(), 143) << bytes_of(log());
    late = is_there("a.ckpt") && !is_there("out.exr");
  }
  EXPECT_TRUE(late) << bytes_of(log());
  EXPECT_TRUE(contains(bytes_of(log()), "--resume " + path("a.ckpt") + " goes on"));
  EXPECT_TRUE(contains(bytes_of(log()), "not written, to end soon: " + path("out.exr")))
      << bytes_of(log());
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(Interruption, WithoutACheckpointThePictureSoFarIsWritten) {
  for (int delay = 300; !is_there("out.exr") && delay < 60'000; delay *= 2) {
    RunningProgram program(render(kEndless, {}), log());
    std::this_thread::sleep_for(Milliseconds(delay));
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 143);
  }
  const Film film = read_exr(path("out.exr"));
  const auto& samples = film.find("samples")->pixels;
  EXPECT_EQ(*std::min_element(samples.begin(), samples.end()), 0) << "rows that were not reached";
  EXPECT_EQ(Imf::InputFile(path("out.exr").c_str()).header().compression(), Imf::NO_COMPRESSION)
      << "compression would delay the end";
  EXPECT_TRUE(contains(bytes_of(log()), "--checkpoint F")) << bytes_of(log());
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(Interruption, BeforeThereAreSamplesItEndsAtOnceAndLeavesNothing) {
  std::vector<std::string> arguments = render(kEndless, {});
  arguments[1] = "scene:tree?leaves=2000000";
  RunningProgram program(arguments, log());
  std::this_thread::sleep_for(Milliseconds(200));
  const double used = processor_seconds(program.process());
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 130);
  EXPECT_LT(processor_seconds(program.usage()) - used, kSanitized ? 60 : 1)
      << "the BVH alone takes several seconds";
  EXPECT_EQ(files_in_folder(), 0u);
}

// With an empty cache a driver compiles for seconds, in other processes and then in this one. On a
// fast machine it is done before the last signal: then there are samples, and they are kept. What
// counts is processor time, which a busy machine does not change; the clock's limit is for drivers
// that wait. The thread sanitizer hands signals on when the thread makes a call that it watches.
TEST_F(Interruption, WhileKernelsCompileItEndsWithinTwoSecondsAndLeavesNothing) {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const std::string before = cache ? cache : "";
  for (const int delay : {300, 1500, 3000}) {
    const std::string folder = folder_.string() + "_cache";
    std::filesystem::create_directory(folder);
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    RunningProgram program(with_checkpoint(kEndless, "1h"), log());
    std::this_thread::sleep_for(Milliseconds(delay));
    const auto sent = steady_clock::now();
    const double used = processor_seconds(program.process());
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 143) << bytes_of(log());
    EXPECT_LT(processor_seconds(program.usage()) - used, kThreadSanitized ? 60 : 2)
        << "after " << delay << " ms";
    EXPECT_LT(steady_clock::now() - sent, Milliseconds(kThreadSanitized ? 60'000 : 15'000))
        << "after " << delay << " ms";
    const bool has_samples = contains(bytes_of(log()), "interrupted after ");
    EXPECT_FALSE(has_samples && delay == 300) << bytes_of(log());
    const bool has_picture = has_samples && !contains(bytes_of(log()), "not written, to end soon");
    EXPECT_EQ(files_in_folder(), has_picture   ? 2u
                                 : has_samples ? 1u
                                               : 0u)
        << "after " << delay << " ms";
    std::filesystem::remove(path("out.exr"));
    std::filesystem::remove(path("a.ckpt"));
    std::filesystem::remove_all(folder);
  }
  before.empty() ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", before.c_str(), 1);
}

TEST_F(Interruption, ASecondInterruptEndsAtOnceWhereTheFirstWaitsForItsSlice) {
  const auto program = render_that_hangs();
  ASSERT_FALSE(program->has_ended()) << bytes_of(log());
  program->send(SIGINT);
  std::this_thread::sleep_for(Milliseconds(500));
  ASSERT_FALSE(program->has_ended()) << bytes_of(log());
  const auto sent = steady_clock::now();
  program->send(SIGINT);
  EXPECT_EQ(program->wait(), 130) << bytes_of(log());
  EXPECT_LT(steady_clock::now() - sent, Milliseconds(10'000))
      << "after one interrupt it is 20 s; the limit allows for a busy machine";
  EXPECT_FALSE(is_there("out.exr"));
}

TEST_F(Interruption, AfterASecondInterruptTheNextRunCleansUp) {
  RunningProgram program(with_checkpoint(kEndless, "0.02"), log());
  ASSERT_TRUE(wait_until([&] { return is_there("a.ckpt"); }, kLongest)) << bytes_of(log());
  program.send(SIGINT);
  std::this_thread::sleep_for(Milliseconds(5));
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 130);
  EXPECT_EQ(run(with_checkpoint(32, "60")), 0) << bytes_of(log());
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(Interruption, IgnoredSignalsStayIgnored) {
  std::signal(SIGINT, SIG_IGN);
  RunningProgram program(with_checkpoint(256, "0.02"), log());
  std::signal(SIGINT, SIG_DFL);
  wait_until([&] { return is_there("a.ckpt") || program.has_ended(); }, kLongest);
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 0) << bytes_of(log());
}

// The picture is larger than the files of the OpenCL compiler, so that these fit into the limit.
TEST_F(Interruption, ACheckpointTooLargeForTheDiskIsAnErrorAndTheOneBeforeIsKept) {
  std::vector<std::string> arguments = with_checkpoint(4, "1h");
  arguments.insert(arguments.end(), {"--crop", "0,100,799,499", "--half", "all"});
  arguments[5] = "800";
  arguments[7] = "600";
  ASSERT_EQ(run(arguments), 0) << bytes_of(log());
  const std::string before = bytes_of(path("a.ckpt"));
  const std::size_t picture = bytes_of(path("out.exr")).size();
  ASSERT_GT(before.size(), picture + picture / 20) << "what the limit is between";
  std::filesystem::remove(path("out.exr"));
  const std::string blocks = std::to_string((picture + before.size()) / 2 / 512);
  std::string command = "trap '' XFSZ && ulimit -f " + blocks + " && '" DAPPLE_PROGRAM "'";
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  const int status = std::system((command + " >'" + log() + "' 2>&1").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(contains(bytes_of(log()), "cannot write " + path("a.ckpt") + ": File too large"))
      << bytes_of(log());
  EXPECT_TRUE(bytes_of(path("a.ckpt")) == before);
  EXPECT_EQ(read_exr(path("out.exr")).width, 800) << "the picture is not lost";
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(Interruption, ADamagedCheckpointExitsWith1AndInvalidTimesWith2) {
  ASSERT_EQ(run(with_checkpoint(4, "1h")), 0) << bytes_of(log());
  std::string bytes = bytes_of(path("a.ckpt"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 16);
  write_bytes(path("b.ckpt"), bytes);
  EXPECT_EQ(run(render(4, {}), "--resume", path("b.ckpt")), 1);
  EXPECT_TRUE(contains(bytes_of(log()), "--resume " + path("b.ckpt") + ": damaged"))
      << bytes_of(log());
  write_bytes(path("c.ckpt"), bytes_of(path("out.exr")));
  EXPECT_EQ(run(render(4, {}), "--resume", path("c.ckpt")), 1);
  EXPECT_EQ(run(render(4, {}), "--resume", path("out.exr")), 2) << "an output is no input";
  EXPECT_EQ(run(render(3, {}), "--resume", path("a.ckpt")), 2);
  EXPECT_EQ(run(render(4, {}), "--checkpoint-every", "5s"), 2) << "without --checkpoint";
  EXPECT_EQ(run(render(4, {}), "--checkpoint", path("missing/a.ckpt")), 2);
  for (const char* every : {"0", "-1", "x", "5d", "", "s", "nan", "1e99"}) {
    EXPECT_EQ(run(with_checkpoint(4, every)), 2) << every;
    EXPECT_TRUE(contains(bytes_of(log()), "--checkpoint-every")) << bytes_of(log());
  }
  for (const char* every : {"30", "0.5s", "5m", "1h"})
    EXPECT_EQ(run(with_checkpoint(4, every)), 0) << bytes_of(log());
}

class KilledRender : public Interruption {};

TEST_F(KilledRender, GoesOnFromTheLastWholeCheckpointToTheSameFile) {
  constexpr int kSamples = 600;
  // A report is that of the samples of the last run.
  const auto render = [&](const std::string& every) {
    std::vector<std::string> arguments = with_checkpoint(kSamples, every);
    arguments.insert(arguments.end(), {"--report-bias", "0"});
    return arguments;
  };
  ASSERT_EQ(run(render("1h")), 0) << bytes_of(log());
  const std::string whole = bytes_of(path("out.exr"));
  std::filesystem::remove(path("a.ckpt"));
  std::mt19937 random(7);
  int killed = 0;
  unsigned longest = 600;  // ms; less where the machine is so fast that renders end before
  for (int attempt = 0; attempt < 20; ++attempt) {
    std::vector<std::string> arguments = render("0.01");
    if (is_there("a.ckpt")) arguments.insert(arguments.end(), {"--resume", path("a.ckpt")});
    RunningProgram program(arguments, log());
    std::this_thread::sleep_for(Milliseconds(longest / 6 + random() % longest));
    program.send(SIGKILL);
    const int code = program.wait();
    EXPECT_TRUE(code == 0 || code == 128 + SIGKILL) << bytes_of(log());
    killed += code != 0;
    if (code != 0) continue;
    EXPECT_TRUE(bytes_of(path("out.exr")) == whole);
    std::filesystem::remove(path("a.ckpt"));  // the next begins anew
    longest = std::max(60u, longest * 2 / 3);
  }
  EXPECT_GT(killed, 4);
  std::vector<std::string> last = render("1h");
  if (is_there("a.ckpt")) last.insert(last.end(), {"--resume", path("a.ckpt")});
  ASSERT_EQ(run(last), 0) << bytes_of(log());
  EXPECT_TRUE(bytes_of(path("out.exr")) == whole);
  EXPECT_EQ(files_in_folder(), 2u) << "nothing is left of those that were killed";
}

}  // namespace
}  // namespace dapple
