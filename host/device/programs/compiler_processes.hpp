// Processes that compile kernels for the kernel cache while this one reads a scene: within one PoCL
// compiles a program at a time.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "device/context.hpp"

namespace dapple {

/// A kernel as an argument of the program, "packet:occlusion/packet:1:0".
std::string text_of(const KernelName& kernel);
/// Throws Error usage.
KernelName parse_kernel(const std::string& text);

class CompilerProcesses {
 public:
  /// A program that compiles kernels when it is called with "compile", as in
  /// host/commands/compile.cpp; without one, as in programs that use the library, none are started.
  static void use(const std::string& program);

  CompilerProcesses() = default;
  /// Those that still run are killed.
  ~CompilerProcesses();
  CompilerProcesses(const CompilerProcesses&) = delete;
  CompilerProcesses& operator=(const CompilerProcesses&) = delete;

  /// Starts as many as there are CPUs, at most four, on those of `kernels` that no process has
  /// compiled before.
  void start(const DeviceContext& context, const std::vector<KernelName>& kernels, CompileTo to);
  /// Until all have ended. What they could not compile is compiled when it is asked for, which says
  /// why.
  void wait();

 private:
  std::vector<pid_t> running_;
};

}  // namespace dapple
