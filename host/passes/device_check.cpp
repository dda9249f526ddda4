// Checks whether a device can run every kernel: compiles each, in several processes where possible,
// and launches none.
#include <fmt/format.h>

#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "device/context.hpp"
#include "device/programs/compiler_processes.hpp"
#include "passes/kernel_list.hpp"
#include "passes/ray_packets.hpp"

namespace dapple {
namespace {

void compile_ahead(const DeviceContext& context) {
  std::vector<KernelName> kernels;
  for (const KernelShape& shape : every_kernel(context)) kernels.push_back(shape.kernel);
  CompilerProcesses processes;
  processes.start(context, kernels, CompileTo::programs);
  processes.wait();
}

}  // namespace

DeviceCheck check_device(const Device& device) {
  DeviceContext& context = device.context();
  compile_ahead(context);
  DeviceCheck check;
  check.packets = packets_in_picture(context, Estimator::prefiltered, 1);
  for (const auto& [kernel, group] : every_kernel(context)) {
    try {
      const std::size_t largest = context.largest_group(kernel);
      if (largest >= group) continue;
      check.refusals.push_back(fmt::format("kernel {} needs work-groups of {} items, of {} at most",
                                           kernel.name, group, largest));
    } catch (const Error& error) {
      // The kernels of a file that does not compile all say the same.
      if (check.refusals.empty() || check.refusals.back() != error.what())
        check.refusals.emplace_back(error.what());
    }
  }
  return check;
}

}  // namespace dapple
