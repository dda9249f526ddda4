// Compiles or loads kernels while the caller's thread builds and uploads a BVH. In: kernel names.
// Out: kernels that the context can launch at once.
#pragma once

#include <vector>

#include "device/programs/compiler_processes.hpp"
#include "device/programs/kernel_loader.hpp"

namespace dapple {

class KernelsAhead {
 public:
  /// Starts compiler processes for those of `kernels` that are not compiled, and loads the others.
  /// Until finish() nobody may ask `context`, which must outlive the object, for kernels or launch
  /// any; uploads are allowed.
  KernelsAhead(DeviceContext& context, std::vector<KernelName> kernels);

  /// Waits for all, and loads what the processes compiled. Kernels that are not compiled are left
  /// to their first launch, which throws what is wrong with them.
  void finish();

 private:
  std::vector<KernelName> kernels_;
  CompilerProcesses processes_;
  KernelLoader loader_;
};

}  // namespace dapple
