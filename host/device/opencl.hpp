// The only door to OpenCL: opencl.hpp as we configure it, and its errors in our words.
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

/// "CL_OUT_OF_RESOURCES" for -5, and so on; the number for codes without a name.
std::string opencl_error_name(int code);

/// Runs `work`; an OpenCL error becomes Error device: "doing failed (call: CL_NAME)".
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
