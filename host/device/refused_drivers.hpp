// Drivers that cannot compile dapple's kernels, by version. In: names that OpenCL tells. Out: why a
// driver is not used.
#pragma once

#include <string>
#include <vector>

namespace dapple {

/// What is wrong with the driver of these names (CL_PLATFORM_NAME, CL_DRIVER_VERSION), and what to
/// install instead; empty where nothing is known to be.
std::string driver_refusal(const std::string& platform, const std::string& version);

/// What is said of a device whose compiler is older than OpenCL C 1.2, by its CL_DEVICE_NAME and
/// CL_DEVICE_OPENCL_C_VERSION; empty for others.
std::string language_refusal(const std::string& device, const std::string& opencl_c);

/// Why installed drivers are not used, each refusal once; platforms.cpp. Throws Error device where
/// no device is left.
std::vector<std::string> refused_drivers();

}  // namespace dapple
