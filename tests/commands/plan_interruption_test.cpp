// A signal ends `dapple plan` at any moment, and its folder of trial files goes with it.
#include <gtest/gtest.h>

#include <filesystem>

#include "device/environment_while.hpp"
#include "support/files/film_files.hpp"
#include "support/programs/running_program.hpp"

namespace dapple {
namespace {

using namespace program_test;

class PlanInterruption : public film_test::FilmFile {
 protected:
  /// Empty if there is none.
  [[nodiscard]] std::filesystem::path trial_folder() const {
    for (const auto& entry : std::filesystem::directory_iterator(path("tmp")))
      if (entry.path().filename().string().starts_with("dapple-run-")) return entry.path();
    return {};
  }
  [[nodiscard]] bool has_trial_folder() const { return !trial_folder().empty(); }
  [[nodiscard]] bool has_trial_file() const {
    std::error_code gone;
    return std::filesystem::directory_iterator(trial_folder(), gone) !=
           std::filesystem::directory_iterator();
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

// A trial's part is removed once it is measured: the folder is empty while another trial is traced.
TEST_F(PlanInterruption, TwoSignalsDuringALaterTrialLeaveNoFolder) {
  std::filesystem::create_directory(path("tmp"));
  const EnvironmentWhile folder("TMPDIR", path("tmp"));
  bool is_sent = false;
  for (int attempt = 0; attempt < 5 && !is_sent; ++attempt) {
    RunningProgram program(
        {"plan", "scene:tree?leaves=50000", "--width", "1920", "--height", "1080", "--spp", "64"},
        path("log"));
    // The part is there for a few milliseconds only.
    while (!has_trial_file() && !program.has_ended()) std::this_thread::yield();
    // Once it is gone, the next trial has begun.
    is_sent = wait_until([&] { return !has_trial_file() || program.has_ended(); }, kLongest) &&
              has_trial_folder();
    for (int i = 0; i < 2; ++i) {
      program.send(SIGINT);
      std::this_thread::sleep_for(Milliseconds(20));
    }
    const int code = program.wait();
    EXPECT_TRUE(code == 130 || code == 0) << code;
    EXPECT_FALSE(has_trial_folder());
  }
  EXPECT_TRUE(is_sent) << "no trial was followed by another";
}

TEST_F(PlanInterruption, WhatAKilledTrialLeftTheNextOneRemoves) {
  std::filesystem::create_directory(path("tmp"));
  const EnvironmentWhile folder("TMPDIR", path("tmp"));
  RunningProgram killed({"plan", "scene:tree?leaves=50000", "--spp", "100000"}, path("log"));
  ASSERT_TRUE(wait_until([&] { return has_trial_folder() || killed.has_ended(); }, kLongest));
  killed.send(SIGKILL);
  killed.wait();
  ASSERT_TRUE(has_trial_folder());
  RunningProgram next({"plan", "scene:tree?leaves=500", "--spp", "4"}, path("log"));
  EXPECT_EQ(next.wait(), 0);
  EXPECT_FALSE(has_trial_folder());
}

}  // namespace
}  // namespace dapple
