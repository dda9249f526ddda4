#include "commands/interruption.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <string_view>
#include <thread>
#include <utility>

#include "commands/tell.hpp"
#include "device/driver_crash.hpp"

namespace dapple {
namespace {

constexpr int kSignalled = 128;           ///< added to a signal's number, as shells do
constexpr unsigned kSecondsOfSlice = 20;  ///< after a signal; more than any on a busy machine
/// The same after SIGTERM or SIGXCPU with checkpoints: only the work since the last one is lost. To
/// free the memory takes a quarter of a second more, on a busy machine four times that: so there is
/// a look at the processor time that the first second brought.
constexpr useconds_t kFirstLook = 999'999, kSecondLook = 600'000;  ///< microseconds, in turn
constexpr double kStarvedShare = 0.6;                              ///< of one processor

/// A render is late if its checkpoint is written later than this after the signal. The picture
/// takes 1.5 times as long again, on busy machines too, and two seconds are the limit for both
/// (experiment 821).
constexpr double kLateSeconds = 0.8;

// The only variables that a signal handler may access.
volatile std::sig_atomic_t received = 0;
volatile std::sig_atomic_t saving = 0;
volatile std::sig_atomic_t noticed = 0;
volatile std::sig_atomic_t ends_early = 0;  // after the looks, not after kSecondsOfSlice
volatile std::sig_atomic_t has_looked = 0;
volatile std::sig_atomic_t in_slice = 0;
volatile std::sig_atomic_t all_traced = 0;
volatile std::sig_atomic_t is_saved = 0;  // all that was traced before the signal
volatile std::sig_atomic_t skips_picture = 0;
volatile std::sig_atomic_t has_temporary = 0;
timespec received_at{}, processor_time{};  // written before `received`
char temporary[4096];                      // written only while has_temporary is 0
char checkpoint[4096];                     // written before ends_early; empty: none, or longer
struct stat earlier {};  // of a file at the checkpoint's path that is not of this render

/// Ends the process from a signal handler, and removes the file or empty folder that
/// remove_when_interrupted() named. Other unfinished outputs have temporary names; the next run
/// removes them.
[[noreturn]] void end_at_once(int signal) {
  if (has_temporary && unlink(temporary) != 0) rmdir(temporary);
  _exit(kSignalled + signal);
}

/// Whether the checkpoint's file is of this render, or of the one that it goes on from.
bool has_checkpoint() {
  struct stat now {};
  if (checkpoint[0] == '\0' || stat(checkpoint, &now) != 0) return false;
  return now.st_ino != earlier.st_ino || now.st_mtim.tv_sec != earlier.st_mtim.tv_sec ||
         now.st_mtim.tv_nsec != earlier.st_mtim.tv_nsec;
}

double seconds_between(const timespec& begin, const timespec& end) {
  return static_cast<double>(end.tv_sec - begin.tv_sec) +
         1e-9 * static_cast<double>(end.tv_nsec - begin.tv_nsec);
}

/// Whether the process had little of the processors since the signal: other programs took them, or
/// it waits for a disk.
bool is_starved() {
  timespec processor_now{}, now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &processor_now);
  clock_gettime(CLOCK_MONOTONIC, &now);
  return seconds_between(processor_time, processor_now) <
         kStarvedShare * seconds_between(received_at, now);
}

/// Says what is not there, unless a note does, which tells that the picture is skipped.
[[noreturn]] void end_with_last_checkpoint() {
  static const char lost[] =
      "dapple: ended before the samples since the last checkpoint were saved\n";
  static const char saved[] =
      "dapple: ended before the picture was written; the checkpoint has all\n";
  const std::string_view text = skips_picture ? "" : is_saved ? saved : lost;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
  end_at_once(received);
}

// A second SIGTERM does not end the process at once: process managers send it twice.
extern "C" void on_interruption(int signal) {
  if (!saving || (received && signal == SIGINT)) end_at_once(signal);
  if (received) return;
  clock_gettime(CLOCK_MONOTONIC, &received_at);
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &processor_time);
  const bool is_writing = noticed != 0;  // another thread may notice this signal from here on
  received = signal;
  if (signal == SIGINT) ends_early = 0;
  if (is_writing) return;
  if (ends_early)
    ualarm(kFirstLook, 0);
  else
    alarm(kSecondsOfSlice);
}

/// A slice takes a fraction of a second. If it does not end, the driver hangs, or compiles. Saving
/// or writing the picture of an interrupted render is given up where there is a checkpoint and the
/// machine is busy (experiment 821).
extern "C" void on_alarm(int) {
  if (ends_early && !has_looked && !(has_checkpoint() && is_starved())) {
    has_looked = 1;
    ualarm(kSecondLook, 0);
    return;
  }
  if (ends_early && !all_traced && has_checkpoint() && is_starved()) end_with_last_checkpoint();
  if (noticed) return;
  if (!ends_early || in_slice) end_at_once(received);
  ends_early = 0;
  alarm(kSecondsOfSlice);
}

/// The kernel sends SIGXCPU at the soft limit of processor time, and SIGKILL at the hard one;
/// `ulimit -t` sets both to the same. Leaves time for saving between them, at most half of all.
void leave_time_to_save() {
  rlimit limit{};
  if (getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY) return;
  const rlim_t saving_seconds = kSecondsOfSlice + std::thread::hardware_concurrency();
  const rlim_t left = std::min(saving_seconds, limit.rlim_max / 2);  // 0 of a single second
  if (limit.rlim_cur + left <= limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max - left;
  setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

void catch_interruptions() {
  leave_time_to_save();
  std::signal(SIGALRM, on_alarm);
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU, SIGHUP}) {
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

void warn_of_checkpoint(const std::string& reason) {
  tell("{}note: {}; the work goes on, and it is tried again\n", isatty(STDERR_FILENO) ? "\n" : "",
       reason);
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

Progress end_early(const std::string& path, const std::string& resumed, Progress progress) {
  checkpoint[path.size() < sizeof checkpoint ? path.copy(checkpoint, path.size()) : 0] = '\0';
  if (path == resumed || stat(path.c_str(), &earlier) != 0) earlier = {};
  ends_early = 1;
  return [progress = std::move(progress)](double fraction) {
    in_slice = 0;
    all_traced = fraction >= 1;
    if (progress) progress(fraction);
  };
}

void slices_are_traced() {
  noticed = 1;
  in_slice = 0;
  if (!is_saved) alarm(0);  // else there is a checkpoint that has all
}

void remove_when_interrupted(const std::string& path) {
  has_temporary = 0;
  if (path.empty() || path.size() >= sizeof temporary) return;
  temporary[path.copy(temporary, path.size())] = '\0';
  has_temporary = 1;
}

bool is_late() {
  is_saved = received;
  if (received == SIGINT) return false;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  skips_picture = seconds_between(received_at, now) > kLateSeconds ? 1 : 0;
  return skips_picture != 0;
}

int interruption_code() { return received ? kSignalled + received : 0; }

}  // namespace dapple
