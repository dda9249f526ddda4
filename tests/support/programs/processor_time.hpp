// Shared by the tests that something takes no longer than it should, on busy machines too: other
// programs disturb the clock on the wall, processor time hardly.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

#include <sstream>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple::program_test {

inline double processor_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Of all processes that this one has waited for.
inline double processor_seconds_of_children() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return processor_seconds(usage);
}

/// Of a process that runs, with those that it has waited for; 0 if it has ended, or without /proc.
inline double processor_seconds(pid_t process) {
  const std::string line = film_test::bytes_of("/proc/" + std::to_string(process) + "/stat");
  // After the name, which is in parentheses: the state, and ten numbers before the four of time.
  const std::size_t name = line.rfind(')');
  if (name == std::string::npos) return 0;
  std::istringstream fields(line.substr(name + 1));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double ticks = 0;
  for (int i = 0; i < 4; ++i) {
    double some = 0;
    fields >> some;
    ticks += some;
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace dapple::program_test
