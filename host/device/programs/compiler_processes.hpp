// Processes that compile kernels for the kernel cache while this one reads a scene. Several are
// needed because PoCL compiles one program at a time in a process. In: kernel names. Out: compiled
// kernels in the kernel cache.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "device/context.hpp"

namespace dapple {

/// A kernel as an argument of the command line, "packet:occlusion/packet:1:0".
std::string text_of(const KernelName& kernel);
/// The inverse of text_of(). Throws Error usage.
KernelName parse_kernel(const std::string& text);

class CompilerProcesses {
 public:
  /// Sets the path of the program that start() runs with the argument "compile", which compiles
  /// kernels as host/commands/compile.cpp does. Without it, as in programs that use the library,
  /// start() does nothing.
  static void use(const std::string& program);

  CompilerProcesses() = default;
  /// Kills the processes that still run.
  ~CompilerProcesses();
  CompilerProcesses(const CompilerProcesses&) = delete;
  CompilerProcesses& operator=(const CompilerProcesses&) = delete;

  /// Starts at most as many processes as there are CPUs, and at most four. They compile those of
  /// `kernels` that are not compiled yet. Starts none on one CPU, or when compiled kernels are not
  /// kept.
  void start(const DeviceContext& context, const std::vector<KernelName>& kernels, CompileTo to);
  /// Waits until all processes have ended. A kernel that they could not compile is compiled in this
  /// process when it is used, which then throws the error.
  void wait();

 private:
  std::vector<pid_t> running_;
};

}  // namespace dapple
