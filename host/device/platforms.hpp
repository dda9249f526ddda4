// Finding OpenCL devices and choosing one.
#pragma once

#include <string>
#include <vector>

#include "dapple/device.hpp"
#include "device/opencl.hpp"

namespace dapple {

/// DeviceInfo::platform of PoCL.
inline constexpr const char* kPoclPlatform = "Portable Computing Language";

DeviceInfo describe(const cl::Device& device);

/// Best first: GPUs, then CPUs, by compute units; never empty. Throws Error device.
std::vector<cl::Device> usable_devices();

/// The first usable device whose name or platform contains `name`, in any case. Throws
/// Error device, listing what there is.
cl::Device choose_device(const std::string& name);

}  // namespace dapple
