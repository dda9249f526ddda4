#include "commands/interruption.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <thread>
#include <utility>

#include "device/driver_crash.hpp"

namespace dapple {
namespace {

constexpr int kSignalled = 128;           ///< added to a signal's number, as shells do
constexpr unsigned kSecondsOfSlice = 20;  ///< after a signal; more than any on a busy machine
/// The same after SIGTERM or SIGXCPU with checkpoints: only the work since the last one is lost.
constexpr unsigned kSecondsWithCheckpoint = 2;

/// A render is late if its checkpoint is written later than this after the signal. The picture
/// takes 1.5 times as long again, on busy machines too, and two seconds are the limit for both.
constexpr double kLateSeconds = 0.8;

// The only variables that a signal handler may access.
volatile std::sig_atomic_t received = 0;
volatile std::sig_atomic_t saving = 0;
volatile std::sig_atomic_t noticed = 0;
volatile std::sig_atomic_t ends_early = 0;  // a slice after kSecondsWithCheckpoint
volatile std::sig_atomic_t in_slice = 0;
volatile std::sig_atomic_t has_temporary = 0;
timespec received_at{};  // written before `received`
char temporary[4096];    // written only while has_temporary is 0

/// Ends the process from a signal handler, and removes the file or empty folder that
/// remove_when_interrupted() named. Other unfinished outputs have temporary names; the next run
/// removes them.
[[noreturn]] void end_at_once(int signal) {
  if (has_temporary && unlink(temporary) != 0) rmdir(temporary);
  _exit(kSignalled + signal);
}

// A second SIGTERM does not end the process at once: process managers send it twice.
extern "C" void on_interruption(int signal) {
  if (!saving || (received && signal == SIGINT)) end_at_once(signal);
  if (received) return;
  clock_gettime(CLOCK_MONOTONIC, &received_at);
  received = signal;
  if (signal == SIGINT) ends_early = 0;
  if (!noticed) alarm(ends_early ? kSecondsWithCheckpoint : kSecondsOfSlice);
}

/// A slice takes a fraction of a second. If it does not end, the driver hangs, or compiles.
extern "C" void on_alarm(int) {
  if (noticed) return;
  if (!ends_early || in_slice) end_at_once(received);
  ends_early = 0;  // it saves, or writes the picture
  alarm(kSecondsOfSlice - kSecondsWithCheckpoint);
}

/// The kernel sends SIGXCPU at the soft limit of processor time, and SIGKILL at the hard one;
/// `ulimit -t` sets both to the same. Leaves time for saving between them, at most half of all.
void leave_time_to_save() {
  rlimit limit{};
  if (getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY) return;
  const rlim_t saving_seconds = kSecondsOfSlice + std::thread::hardware_concurrency();
  const rlim_t left = std::min(saving_seconds, limit.rlim_max / 2);
  if (limit.rlim_cur + left <= limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max - left;
  setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

void catch_interruptions() {
  leave_time_to_save();
  std::signal(SIGALRM, on_alarm);
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
      action = {};
      action.sa_handler = on_interruption;
      action.sa_flags = SA_RESTART;
      sigaction(signal, &action, nullptr);
    }
    keep_signal_handler(signal);
  }
  keep_signal_handler(SIGQUIT);  // Ctrl-\ ends the process, as by default
}

Stop save_when_interrupted() {
  // Until the first slice is traced there is nothing to save, and its kernels may compile for long.
  return [slices = 0]() mutable {
    if (slices++ > 0) saving = 1;
    noticed = received;
    in_slice = received ? 0 : 1;
    return received != 0;
  };
}

Progress end_hanging_slices_early(Progress progress) {
  ends_early = 1;
  return [progress = std::move(progress)](double fraction) {
    in_slice = 0;
    if (progress) progress(fraction);
  };
}

void slices_are_traced() {
  noticed = 1;
  in_slice = 0;
  alarm(0);
}

void remove_when_interrupted(const std::string& path) {
  has_temporary = 0;
  if (path.empty() || path.size() >= sizeof temporary) return;
  temporary[path.copy(temporary, path.size())] = '\0';
  has_temporary = 1;
}

bool is_late() {
  if (received != SIGTERM && received != SIGXCPU) return false;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec - received_at.tv_sec) +
             1e-9 * static_cast<double>(now.tv_nsec - received_at.tv_nsec) >
         kLateSeconds;
}

int interruption_code() { return received ? kSignalled + received : 0; }

}  // namespace dapple
