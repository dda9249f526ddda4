// The signal handler prints with write() and ends with _exit(). The name of the driver's work is
// stored before the handler can run.
#include "device/driver_crash.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "dapple/error.hpp"

namespace dapple {
namespace {

std::atomic<bool> reporting{false};
std::atomic<int> calls_under_way{0};
std::atomic<int> devices_open{0};

/// The driver's latest task, zero-terminated. Threads may write here at the same time; if a crash
/// happens then, only the message is garbled.
std::array<std::atomic<char>, 160> doing{};

void say(const char* text) { (void)!write(STDERR_FILENO, text, std::strlen(text)); }

void say_task() {
  std::array<char, doing.size()> task;
  std::copy(doing.begin(), doing.end(), task.begin());
  say(task.data());
}

const char* name_of(int signal) {
  switch (signal) {
    case SIGABRT:
      return "it aborted";
    case SIGBUS:
      return "a file or memory it used went away";
    default:
      return "it reached for memory that is not there";
  }
}

/// An abort counts as the driver's while a device is open, since the driver compiles kernels at
/// their first launch, on its own threads. Other signals count as its own only during a call.
void on_crash(int signal) {
  const bool of_driver = calls_under_way > 0 || (signal == SIGABRT && devices_open > 0);
  if (!of_driver) {
    std::signal(signal, SIG_DFL);
    raise(signal);
    return;
  }
  say("dapple: the OpenCL driver crashed while ");
  say_task();
  say(": ");
  say(name_of(signal));
  say(". What it said itself is above; often memory (ulimit -v) or disk space has run out, "
      "or a variable of the driver's is wrong (POCL_MAX_PTHREAD_COUNT, POCL_DEVICES). --device "
      "chooses another device\n");
  _exit(static_cast<int>(ErrorKind::device));
}

/// LLVM ends the process itself where it cannot write a file.
void on_exit_of_driver() {
  if (!reporting || (calls_under_way == 0 && devices_open == 0)) return;
  say("dapple: the OpenCL driver ended the process while ");
  say_task();
  say(". What it said itself is above; often disk space has run out, of its cache "
      "(XDG_CACHE_HOME, or ~/.cache) or of TMPDIR\n");
  _exit(static_cast<int>(ErrorKind::device));
}

struct KeptHandler {
  int signal;
  void (*handler)(int);
  int flags;
};
std::array<KeptHandler, 8> kept{};
std::atomic<std::size_t> kept_count{0};

void renew_kept_handlers() {
  for (std::size_t i = 0; i < kept_count; ++i) {
    struct sigaction action {};
    sigaction(kept[i].signal, nullptr, &action);
    if (action.sa_handler == kept[i].handler) continue;
    action = {};
    action.sa_handler = kept[i].handler;
    action.sa_flags = kept[i].flags;
    sigaction(kept[i].signal, &action, nullptr);
  }
}

}  // namespace

void keep_signal_handler(int signal) {
  struct sigaction action {};
  if (kept_count == kept.size() || sigaction(signal, nullptr, &action) != 0) return;
  kept[kept_count] = {signal, action.sa_handler, action.sa_flags};
  ++kept_count;
}

void report_driver_crashes() {
  if (!reporting.exchange(true)) std::atexit(on_exit_of_driver);
  renew_crash_reports();
}

void expect_exit() { reporting = false; }

void renew_crash_reports() {
  if (!reporting) return;
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGABRT, SIGBUS, SIGSEGV, SIGILL}) sigaction(signal, &action, nullptr);
}

DriverAtWork::DriverAtWork(const std::string& what) {
  const std::size_t length = std::min(what.size(), doing.size() - 1);
  for (std::size_t i = 0; i < length; ++i) doing[i].store(what[i], std::memory_order_relaxed);
  doing[length].store('\0', std::memory_order_relaxed);
  ++calls_under_way;
}

DriverAtWork::~DriverAtWork() {
  --calls_under_way;
  renew_kept_handlers();
}

DriverInUse::DriverInUse() { ++devices_open; }

DriverInUse::~DriverInUse() { --devices_open; }

}  // namespace dapple
