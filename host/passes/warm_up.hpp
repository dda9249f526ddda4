// Warm-up: compiles kernels completely, by launching each as its pass does but without work. In: a
// kernel of kernel_list.hpp. Out: compiled machine code in PoCL's cache.
#pragma once

#include "dapple/device.hpp"
#include "device/context.hpp"

namespace dapple {

/// Whether it is one of every_kernel().
[[nodiscard]] bool can_warm_up(const KernelName& kernel);

/// Launches kernels of every_kernel(). Throws Error usage for other kernels.
void warm_up(const Device& device, const std::vector<KernelName>& kernels);

}  // namespace dapple
