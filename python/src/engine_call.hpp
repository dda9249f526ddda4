// A call from Python into the engine: without Python's lock, one at a time, with progress, and
// ended by Ctrl-C or by an exception of the progress function.
#pragma once

#include <nanobind/nanobind.h>

#include <exception>
#include <utility>

#include "dapple/error.hpp"
#include "dapple/render.hpp"

namespace dapple::python {

namespace nb = nanobind;

/// Holds the engine for this thread. Throws Error usage if the thread holds it already (a progress
/// function calls dapple), KeyboardInterrupt while it waits for another thread, or if the engine
/// was used before this process was forked: the threads of OpenCL and TBB do not survive a fork.
class EngineLock {
 public:
  EngineLock();
  ~EngineLock();
  EngineLock(const EngineLock&) = delete;
  EngineLock& operator=(const EngineLock&) = delete;
};

/// A RenderControl that calls `progress`, a Python function or None, and checks for signals.
class ControlFromPython {
 public:
  explicit ControlFromPython(nb::object progress) : progress_(std::move(progress)) {}

  [[nodiscard]] RenderControl control();
  /// Throws the exception that ended the call, if one did.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void call(double fraction);
  bool stop();

  nb::object progress_;
  std::exception_ptr failure_;
};

/// Returns work(control), which runs without Python's lock.
template <class Work>
auto call_engine(const nb::object& progress, Work work) {
  ControlFromPython from_python(progress);
  try {
    auto result = [&] {
      const nb::gil_scoped_release released;
      const EngineLock lock;
      return work(from_python.control());
    }();
    from_python.rethrow();
    return result;
  } catch (const Error&) {
    from_python.rethrow();
    throw;
  }
}

}  // namespace dapple::python
