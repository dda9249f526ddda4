// Finds OpenCL devices and chooses one. In: part of a device's name. Out: OpenCL devices, best
// first, and their descriptions.
#pragma once

#include <string>
#include <vector>

#include "dapple/device.hpp"
#include "device/opencl.hpp"
#include "device/platform_names.hpp"

namespace dapple {

/// Throws Error device.
DeviceInfo describe(const cl::Device& device);

/// Whether its memory is not the host's. No, if the driver does not know.
bool has_own_memory(const cl::Device& device);

/// Devices that can compile kernels, best first: GPUs, those with memory of their own before
/// others, then CPUs, then the rest, each by compute units; Mesa's CPUs last. Without those of
/// refused drivers. Never empty. Throws Error device.
std::vector<cl::Device> usable_devices();

/// The first usable device called `name`, or else whose name or platform contains it, in upper or
/// lower case. Throws
/// Error device, listing the usable devices, when none matches; Error failed when PoCL cannot write
/// its files.
cl::Device choose_device(const std::string& name);

}  // namespace dapple
