// A signal ends `dapple plan` at any moment, and its folder of trial files goes with it.
#include <gtest/gtest.h>

#include <filesystem>

#include "device/environment_while.hpp"
#include "support/film_files.hpp"
#include "support/running_program.hpp"

namespace dapple {
namespace {

using namespace program_test;

class PlanInterruption : public film_test::FilmFile {
 protected:
  [[nodiscard]] bool has_trial_folder() const {
    for (const auto& entry : std::filesystem::directory_iterator(path("tmp")))
      if (entry.path().filename().string().starts_with("dapple-plan-")) return true;
    return false;
  }
};

TEST_F(PlanInterruption, ASignalLeavesNoFolder) {
  std::filesystem::create_directory(path("tmp"));
  const EnvironmentWhile folder("TMPDIR", path("tmp"));
  for (const int milliseconds : {0, 300, 1000}) {
    SCOPED_TRACE(milliseconds);
    RunningProgram program({"plan", "scene:tree?leaves=50000", "--spp", "100000"}, path("log"));
    ASSERT_TRUE(wait_until([&] { return has_trial_folder() || program.has_ended(); }, kLongest));
    std::this_thread::sleep_for(Milliseconds(milliseconds));
    program.send(SIGINT);
    const int code = program.wait();
    EXPECT_TRUE(code == 130 || (code == 0 && milliseconds > 0)) << code;
    EXPECT_FALSE(has_trial_folder());
  }
}

}  // namespace
}  // namespace dapple
