// Two processes that are given the same files at once: an image and a checkpoint are whole and of
// one of them, both processes end as if they were alone, and nothing else is left.
#include <gtest/gtest.h>

#include "support/files/film_files.hpp"
#include "support/programs/running_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class SharedFiles : public FilmFile {
 protected:
  ~SharedFiles() override {
    for (const char* end : {".1", ".2"}) std::filesystem::remove(folder_.string() + end);
  }
  /// A render of seed `seed` into files that do not depend on it.
  [[nodiscard]] std::vector<std::string> render(int seed, int spp) const {
    return {"render",
            "scene:tree?leaves=1000",
            "-o",
            path("out.exr"),
            "--png",
            path("out.png"),
            "--width",
            "320",
            "--height",
            "240",
            "--spp",
            std::to_string(spp),
            "--checkpoint",
            path("a.ckpt"),
            "--seed",
            std::to_string(seed),
            "--report-bias",
            "0",
            "--stats-json",
            path("out.json"),
            "--checkpoint-every",
            "0.01"};
  }
  [[nodiscard]] std::string log(int seed) const {
    return folder_.string() + "." + std::to_string(seed);
  }
  [[nodiscard]] int run(const std::vector<std::string>& arguments) const {
    return RunningProgram(arguments, log(1)).wait();
  }
  [[nodiscard]] std::vector<std::string> resumed(int seed, int spp) const {
    std::vector<std::string> arguments = render(seed, spp);
    arguments.insert(arguments.end(), {"--resume", path("a.ckpt")});
    return arguments;
  }
  [[nodiscard]] bool is_there(const char* name) const {
    return std::filesystem::exists(path(name));
  }
  /// The seed of the checkpoint: the only one that resumes it.
  [[nodiscard]] int seed_of_checkpoint(int spp) const {
    const std::string checkpoint = bytes_of(path("a.ckpt"));
    const int first = run(resumed(1, spp));
    write_bytes(path("a.ckpt"), checkpoint);
    const int second = run(resumed(2, spp));
    EXPECT_TRUE((first == 0 && second == 2) || (first == 2 && second == 0))
        << first << " and " << second << ": " << bytes_of(log(1));
    return first == 0 ? 1 : 2;
  }
};

TEST_F(SharedFiles, OfTwoRendersAtOnceAreWholeAndThoseOfOneOfThem) {
  std::vector<std::string> alone_exr, alone_png;
  for (const int seed : {1, 2}) {
    ASSERT_EQ(run(render(seed, 8)), 0) << bytes_of(log(1));
    alone_exr.push_back(bytes_of(path("out.exr")));
    alone_png.push_back(bytes_of(path("out.png")));
  }
  ASSERT_FALSE(alone_exr[0] == alone_exr[1]);
  ASSERT_FALSE(alone_png[0] == alone_png[1]);
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const char* name : {"out.exr", "out.png", "a.ckpt"}) std::filesystem::remove(path(name));
    RunningProgram first(render(1, 8), log(1)), second(render(2, 8), log(2));
    EXPECT_EQ(first.wait(), 0) << bytes_of(log(1));
    EXPECT_EQ(second.wait(), 0) << bytes_of(log(2));
    const std::string exr = bytes_of(path("out.exr")), png = bytes_of(path("out.png"));
    EXPECT_TRUE(exr == alone_exr[0] || exr == alone_exr[1]);
    EXPECT_TRUE(png == alone_png[0] || png == alone_png[1]);
    EXPECT_EQ(files_in_folder(), 4U);
    // Finished, so there is no more to trace: the image is that of the checkpoint's render.
    const int seed = seed_of_checkpoint(8);
    EXPECT_TRUE(bytes_of(path("out.exr")) == alone_exr.at(static_cast<std::size_t>(seed) - 1));
  }
}

TEST_F(SharedFiles, OfTwoInterruptedRendersTheCheckpointGoesOn) {
  constexpr int kEndless = 1 << 20;
  RunningProgram first(render(1, kEndless), log(1)), second(render(2, kEndless), log(2));
  ASSERT_TRUE(wait_until([&] { return is_there("a.ckpt"); }, kLongest))
      << bytes_of(log(1)) << bytes_of(log(2));
  std::this_thread::sleep_for(Milliseconds(500));
  for (const RunningProgram* program : {&first, &second}) program->send(SIGTERM);
  EXPECT_EQ(first.wait(), 143) << bytes_of(log(1));
  EXPECT_EQ(second.wait(), 143) << bytes_of(log(2));
  for (const char* name : {"out.exr", "out.png", "out.json"}) std::filesystem::remove(path(name));
  EXPECT_EQ(files_in_folder(), 1U);
  std::string other;
  for (const int seed : {1, 2}) {
    std::vector<std::string> arguments = resumed(seed, kEndless);
    const auto before = std::filesystem::last_write_time(path("a.ckpt"));
    RunningProgram again(arguments, log(seed));
    const auto goes_on_or_ended = [&] {
      return again.has_ended() || std::filesystem::last_write_time(path("a.ckpt")) != before;
    };
    ASSERT_TRUE(wait_until(goes_on_or_ended, kLongest)) << bytes_of(log(seed));
    again.send(SIGTERM);
    const int code = again.wait();
    EXPECT_TRUE(code == 143 || code == 2) << bytes_of(log(seed));
    if (code == 2) other += bytes_of(log(seed));
  }
  EXPECT_TRUE(contains(other, "--seed")) << other;
}

}  // namespace
}  // namespace dapple
