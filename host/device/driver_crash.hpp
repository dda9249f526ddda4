// What becomes of the process when an OpenCL driver gives up: PoCL and the LLVM inside it abort
// where memory, disk or their linker fail them, and there is no error to catch.
#pragma once

#include <string>

namespace dapple {

/// From now on such an end is one line, "dapple: the OpenCL driver crashed while compiling kernel
/// packet ...", and exit code 4 instead of a signal. For programs: the library never calls it.
void report_driver_crashes();

/// Takes the signals back where a driver that was just loaded has taken them for itself, as the
/// LLVM in PoCL does. Nothing where report_driver_crashes() was never called.
void renew_crash_reports();

/// While it lives, a crash in any thread is the driver's; `what` it was asked to do last is named.
class DriverAtWork {
 public:
  explicit DriverAtWork(const std::string& what);
  ~DriverAtWork();
  DriverAtWork(const DriverAtWork&) = delete;
  DriverAtWork& operator=(const DriverAtWork&) = delete;
};

/// While it lives, the driver's threads may abort at any time: a device is open.
class DriverInUse {
 public:
  DriverInUse();
  ~DriverInUse();
  DriverInUse(const DriverInUse&) = delete;
  DriverInUse& operator=(const DriverInUse&) = delete;
};

}  // namespace dapple
