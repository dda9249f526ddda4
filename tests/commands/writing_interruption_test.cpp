// A signal that comes while a finished picture is written: the program writes the picture to its
// end, however long that takes, and ends with the signal's exit code. Slow: longer than a hanging
// driver is waited for.
#include <gtest/gtest.h>

#include "support/film_files.hpp"
#include "support/running_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class WritingInterruption : public FilmFile {
 protected:
  ~WritingInterruption() override { std::filesystem::remove(log()); }

  [[nodiscard]] std::vector<std::string> render(int side) const {
    return {"render",   "scene:cube?divisions=1",
            "-o",       path("out.exr"),
            "--width",  std::to_string(side),
            "--height", std::to_string(side),
            "--spp",    "1",
            "--passes", "ao"};
  }
  /// Whether the file that becomes the picture is there, under its temporary name.
  [[nodiscard]] bool is_writing() const {
    for (const auto& file : std::filesystem::directory_iterator(folder_))
      if (file.path().filename().string().starts_with(".dapple-")) return true;
    return false;
  }
  [[nodiscard]] bool has_picture() const { return std::filesystem::exists(path("out.exr")); }
  /// Outside of the folder, so that files_in_folder() does not count it.
  [[nodiscard]] std::string log() const { return folder_.string() + ".log"; }
};

// The program stands still while it writes, as on a disk that is very slow. The picture may be
// written before; then the next try has a larger one.
TEST_F(WritingInterruption, ThePictureIsWrittenToItsEndAfterMoreThanTwentySeconds) {
  for (int side = 2'000; side <= 16'000; side *= 2) {
    std::filesystem::remove(path("out.exr"));
    RunningProgram program(render(side), log());
    ASSERT_TRUE(wait_until([&] { return is_writing() || program.has_ended(); }, kLongest));
    program.send(SIGTERM);
    std::this_thread::sleep_for(Milliseconds(20));  // for the program's handler
    program.send(SIGSTOP);
    std::this_thread::sleep_for(Milliseconds(100));
    if (program.has_ended() || has_picture()) {
      program.send(SIGCONT);
      program.wait();
      continue;
    }
    std::this_thread::sleep_for(Milliseconds(21'000));
    program.send(SIGCONT);
    EXPECT_EQ(program.wait(), 143) << bytes_of(log());
    ASSERT_TRUE(has_picture()) << "it was ended while it wrote";
    EXPECT_EQ(read_exr(path("out.exr")).width, side);
    EXPECT_EQ(files_in_folder(), 1u);
    EXPECT_TRUE(contains(bytes_of(log()), "wrote " + path("out.exr"))) << bytes_of(log());
    return;
  }
  FAIL() << "no picture was large enough";
}

}  // namespace
}  // namespace dapple
