// Reports crashes of OpenCL drivers. PoCL and the LLVM inside it abort the process when memory,
// disk space or their linker fails; no error can be caught. In: signals, and what the driver is
// doing. Out: one line on standard error, and the exit code.
#pragma once

#include <string>

namespace dapple {

/// From now on a crash of the driver prints one line, "dapple: the OpenCL driver crashed while
/// compiling kernel packet ...", and ends the process with exit code 4 instead of a signal. So it
/// does when the driver calls exit(). For programs: the library never calls it.
void report_driver_crashes();

/// From now on the process exits by itself, and nothing is reported.
void expect_exit();

/// Sets the signal handlers again after a driver was loaded, which may have replaced them, as the
/// LLVM in PoCL does. Does nothing if report_driver_crashes() was never called.
void renew_crash_reports();

/// The present handler of `signal` is set again, too, whenever a driver replaced it: the LLVM in
/// PoCL takes SIGXCPU, and ignores the first.
void keep_signal_handler(int signal);

/// While an object lives, a crash in any thread counts as the driver's, and the report names the
/// latest `what`, the driver's task.
class DriverAtWork {
 public:
  explicit DriverAtWork(const std::string& what);
  ~DriverAtWork();
  DriverAtWork(const DriverAtWork&) = delete;
  DriverAtWork& operator=(const DriverAtWork&) = delete;
};

/// While an object lives, a device is open, and an abort in any thread counts as the driver's.
class DriverInUse {
 public:
  DriverInUse();
  ~DriverInUse();
  DriverInUse(const DriverInUse&) = delete;
  DriverInUse& operator=(const DriverInUse&) = delete;
};

}  // namespace dapple
