// A program whose driver hangs: what SIGTERM must do to it. For renders and bakes with checkpoints.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>

#include "support/files/film_files.hpp"
#include "support/programs/running_program.hpp"

namespace dapple::program_test {

/// Sends SIGTERM and expects the end within two seconds. `log`: the file of what the program
/// printed.
inline void expect_end_in_two_seconds(RunningProgram& program, const std::string& log) {
  const auto sent = std::chrono::steady_clock::now();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 143) << film_test::bytes_of(log);
  EXPECT_GE(std::chrono::steady_clock::now() - sent, Milliseconds(900)) << "it did not hang";
  EXPECT_LT(std::chrono::steady_clock::now() - sent, Milliseconds(15'000))
      << "without checkpoints it is 20 s; the limit allows for a busy machine";
}

}  // namespace dapple::program_test
