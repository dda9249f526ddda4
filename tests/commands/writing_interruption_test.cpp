// A signal that comes while a finished picture is written: the program writes the picture to its
// end, however long that takes, and ends with the signal's exit code. So it does if the signal
// comes while the last checkpoint is written. Slow: longer than a hanging driver is waited for.
#include <gtest/gtest.h>

#include "support/files/film_files.hpp"
#include "support/programs/running_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class WritingInterruption : public FilmFile {
 protected:
  ~WritingInterruption() override {
    std::filesystem::remove(log());
    std::filesystem::remove_all(checkpoints());
  }

  /// The program gets SIGTERM while it writes a file in `folder`, and then stands still, as on a
  /// disk that is very slow. The file may be written before; then the next try has a larger one.
  void expect_written_after(Milliseconds still, const std::filesystem::path& folder,
                            const std::vector<std::string>& before,
                            const std::vector<std::string>& more) const {
    for (int side = 1'000; side <= 16'000; side *= 2) {
      if (!before.empty()) {
        ASSERT_EQ(RunningProgram(render(side, before), log()).wait(), 0) << bytes_of(log());
      }
      std::filesystem::remove(path("out.exr"));
      RunningProgram program(render(side, more), log());
      ASSERT_TRUE(wait_until([&] { return is_writing(folder) || program.has_ended(); }, kLongest));
      program.send(SIGTERM);
      std::this_thread::sleep_for(Milliseconds(20));  // for the program's handler
      program.send(SIGSTOP);
      std::this_thread::sleep_for(Milliseconds(100));
      if (program.has_ended() || has_picture()) {
        program.send(SIGCONT);
        program.wait();
        continue;
      }
      std::this_thread::sleep_for(still);
      program.send(SIGCONT);
      EXPECT_EQ(program.wait(), 143) << bytes_of(log());
      ASSERT_TRUE(has_picture()) << "it was ended while it wrote: " << bytes_of(log());
      EXPECT_EQ(read_exr(path("out.exr")).width, side);
      EXPECT_EQ(files_in_folder(), 1u);
      EXPECT_TRUE(contains(bytes_of(log()), "wrote " + path("out.exr"))) << bytes_of(log());
      return;
    }
    FAIL() << "no picture was large enough";
  }

  /// A folder beside that of the picture, so that a temporary file tells what is written.
  [[nodiscard]] std::string checkpoints() const { return folder_.string() + ".saved"; }

 private:
  [[nodiscard]] std::vector<std::string> render(int side,
                                                const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"render",   "scene:cube?divisions=1",
                                       "-o",       path("out.exr"),
                                       "--width",  std::to_string(side),
                                       "--height", std::to_string(side),
                                       "--passes", "ao"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// Whether a file that is not complete is there, under its temporary name.
  [[nodiscard]] static bool is_writing(const std::filesystem::path& folder) {
    for (const auto& file : std::filesystem::directory_iterator(folder))
      if (file.path().filename().string().starts_with(".dapple-")) return true;
    return false;
  }
  [[nodiscard]] bool has_picture() const { return std::filesystem::exists(path("out.exr")); }
  /// Outside of the folder, so that files_in_folder() does not count it.
  [[nodiscard]] std::string log() const { return folder_.string() + ".log"; }
};

TEST_F(WritingInterruption, ThePictureIsWrittenToItsEndAfterMoreThanTwentySeconds) {
  expect_written_after(Milliseconds(21'000), folder_, {}, {"--spp", "1"});
}

// With a checkpoint the program is gone after two seconds where it has no processor time, unless
// all samples are traced. It goes on from an earlier one, and writes no other than the last.
TEST_F(WritingInterruption, AFinishedPictureIsSavedAndWrittenOnABusyMachine) {
  std::filesystem::create_directory(checkpoints());
  const std::string saved = checkpoints() + "/a.ckpt";
  expect_written_after(
      Milliseconds(3'000), checkpoints(), {"--spp", "1", "--checkpoint", saved},
      {"--spp", "4", "--resume", saved, "--checkpoint", saved, "--checkpoint-every", "1h"});
}

}  // namespace
}  // namespace dapple
