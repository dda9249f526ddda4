// Runs the program in a process that a test can send signals to. In: arguments and signals; out:
// its exit code, what it used, and a file with what it printed.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace dapple::program_test {

using Milliseconds = std::chrono::milliseconds;

/// More than anything takes on a busy machine, and less than tests may take.
constexpr Milliseconds kLongest{240'000};

/// Waits until `condition` is true, at most `limit`; returns whether it became true.
inline bool wait_until(const std::function<bool()>& condition, Milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(Milliseconds(2));
  }
  return true;
}

class RunningProgram {
 public:
  /// Starts the program with `arguments`; all that it prints goes into the file `output`.
  RunningProgram(const std::vector<std::string>& arguments, const std::string& output) {
    std::vector<char*> argv{const_cast<char*>(DAPPLE_PROGRAM)};
    for (const std::string& argument : arguments)
      argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // where the test is killed, so is the program
    const int file = open(output.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0666);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execv(DAPPLE_PROGRAM, argv.data());
    _exit(127);
  }
  ~RunningProgram() {
    if (!ended_) {
      send(SIGKILL);
      wait();
    }
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  [[nodiscard]] pid_t process() const { return process_; }
  void send(int signal) const { kill(process_, signal); }
  [[nodiscard]] bool has_ended() {
    if (!ended_) ended_ = wait4(process_, &status_, WNOHANG, &usage_) == process_;
    return ended_;
  }
  /// Waits for the end; returns the exit code, or 128 + signal if a signal ended it, as shells do.
  /// A program that does not end fails the test, and is killed.
  int wait(Milliseconds limit = kLongest) {
    if (!wait_until([this] { return has_ended(); }, limit)) {
      ADD_FAILURE() << "the program has not ended in " << limit.count() << " ms";
      send(SIGKILL);
      wait4(process_, &status_, 0, &usage_);
      ended_ = true;
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }
  /// Of a program that has ended, with the processes that it waited for.
  [[nodiscard]] const rusage& usage() const { return usage_; }

 private:
  pid_t process_ = 0;
  int status_ = 0;
  rusage usage_{};
  bool ended_ = false;
};

}  // namespace dapple::program_test
