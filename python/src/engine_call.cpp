#include "engine_call.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "dapple/error.hpp"

namespace dapple::python {
namespace {

std::timed_mutex engine;
std::atomic<std::thread::id> holder;
std::atomic<pid_t> user = 0;  ///< the process that used the engine first

}  // namespace

EngineLock::EngineLock() {
  if (holder == std::this_thread::get_id())
    throw Error(ErrorKind::usage,
                "a progress function must not call dapple; to end the call, raise an exception");
  pid_t first = 0;
  if (!user.compare_exchange_strong(first, getpid()) && first != getpid())
    throw Error(ErrorKind::usage,
                "dapple was used before this process was forked, and its threads do not survive "
                "that; use multiprocessing.get_context(\"spawn\") or call dapple only in the "
                "children");
  while (!engine.try_lock_for(std::chrono::milliseconds(100))) {
    const nb::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) nb::raise_python_error();
  }
  holder = std::this_thread::get_id();
}

EngineLock::~EngineLock() {
  holder = std::thread::id();
  engine.unlock();
}

RenderControl ControlFromPython::control() {
  RenderControl control;
  if (!progress_.is_none()) control.progress = [this](double fraction) { call(fraction); };
  control.stop = [this] { return stop(); };
  return control;
}

void ControlFromPython::call(double fraction) {
  if (failure_) return;
  const nb::gil_scoped_acquire acquired;
  try {
    progress_(fraction);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

bool ControlFromPython::stop() {
  if (failure_) return true;
  const nb::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() == 0) return false;
  try {
    nb::raise_python_error();
  } catch (...) {
    failure_ = std::current_exception();
  }
  return true;
}

}  // namespace dapple::python
