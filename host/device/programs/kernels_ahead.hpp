// Compiles or loads kernels while the caller's thread reads a scene and builds its BVH. In: kernel
// names. Out: kernels that the context can launch at once.
#pragma once

#include <vector>

#include "device/programs/compiler_processes.hpp"
#include "device/programs/kernel_loader.hpp"

namespace dapple {

class KernelsAhead {
 public:
  /// Starts compiler processes for those of `kernels` that are not compiled, and loads the others.
  /// Until finish() no other thread may ask `context`, which must outlive the object, for kernels.
  KernelsAhead(DeviceContext& context, std::vector<KernelName> kernels);

  /// Waits for all, and loads what the processes compiled. Throws Error device for a kernel that
  /// cannot be compiled.
  void finish();

 private:
  DeviceContext& context_;
  std::vector<KernelName> kernels_;
  CompilerProcesses processes_;
  KernelLoader loader_;
};

}  // namespace dapple
