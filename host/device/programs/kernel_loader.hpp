// Loads compiled kernels on a thread of its own while the caller's thread reads a scene and builds
// its BVH: PoCL takes 0.04 s for each program that is compiled already. In: kernel names. Out:
// kernels that the context need not load any more.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "device/context.hpp"

namespace dapple {

class KernelLoader {
 public:
  /// `context` must outlive the object. Between start() and wait() or stop() no other thread may
  /// ask it for kernels or launch them.
  explicit KernelLoader(DeviceContext& context) : context_(context) {}
  ~KernelLoader() { stop(); }
  KernelLoader(const KernelLoader&) = delete;
  KernelLoader& operator=(const KernelLoader&) = delete;

  /// Begins to load `kernels` in this order, in place of what was still to come. Leaves out kernels
  /// that are not compiled, because compiling takes seconds and cannot be stopped, and those that
  /// cannot be loaded: DeviceContext::prepare() throws the error later.
  void start(std::vector<KernelName> kernels);
  /// Waits until all are loaded.
  void wait();
  /// Waits only for the program that is being loaded.
  void stop();

 private:
  void load(const std::vector<KernelName>& kernels);

  DeviceContext& context_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace dapple
