// Kernels compiled to the last: launched, as passes launch them, over nothing.
#pragma once

#include "dapple/device.hpp"
#include "device/context.hpp"

namespace dapple {

/// One of every_kernel(). Throws Error usage for any other.
void warm_up(const Device& device, const std::vector<KernelName>& kernels);

}  // namespace dapple
