// Includes OpenCL's C++ header with dapple's settings, and translates its errors into
// dapple::Error. Every other file includes OpenCL through this one.
#pragma once

#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_TARGET_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
#include <CL/opencl.hpp>
#pragma GCC diagnostic pop

#include <string>
#include <utility>

#include "dapple/error.hpp"
#include "device/driver_crash.hpp"

namespace dapple {

/// The name of an OpenCL error code, "CL_OUT_OF_RESOURCES" for -5; "error CODE" if it has none
/// here.
std::string opencl_error_name(int code);

/// Runs `work` and returns its result. An OpenCL error becomes Error device, "DOING failed (CALL:
/// CL_NAME)".
template <class Work>
auto in_opencl(const std::string& doing, const Work& work) -> decltype(work()) {
  const DriverAtWork at_work(doing);
  try {
    return work();
  } catch (const cl::Error& error) {
    throw Error(ErrorKind::device,
                doing + " failed (" + error.what() + ": " + opencl_error_name(error.err()) + ")");
  }
}

}  // namespace dapple
