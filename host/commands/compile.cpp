// dapple compile: the process that CompilerProcesses starts. It is hidden from --help.
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "commands/arguments/option_text.hpp"
#include "commands/command.hpp"
#include "device/context.hpp"
#include "device/programs/compiler_processes.hpp"
#include "passes/warm_up.hpp"

namespace dapple {
namespace {

struct CompileArguments {
  std::string device, kernel_dir, packets = "auto";
  bool programs = false;
  int parent = 0;
  std::vector<std::string> kernels;
};

/// The process ends when its parent ends, for any reason.
void end_with(int parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) std::raise(SIGKILL);
}

void run_compile(const CompileArguments& a) {
  if (a.parent) end_with(a.parent);
  setenv("POCL_MAX_PTHREAD_COUNT", "1", 1);  // the system chooses the CPU
  std::vector<KernelName> kernels;
  for (const std::string& text : a.kernels) kernels.push_back(parse_kernel(text));
  const Device device(a.device, a.kernel_dir, parse_packets(a.packets));
  if (!a.programs) return warm_up(device, kernels);
  for (const KernelName& kernel : kernels) device.context().prepare(kernel);
}

}  // namespace

Run add_compile_command(CLI::App& app) {
  auto a = std::make_shared<CompileArguments>();
  app.group("");
  app.add_option("--device", a->device, "Part of an OpenCL device's name");
  app.add_option("--kernel-dir", a->kernel_dir, "Read OpenCL kernels from this folder");
  app.add_option("--packets", a->packets, "scalar has other programs than all others");
  app.add_option("--parent", a->parent, "The process that waits for it");
  app.add_flag("--programs", a->programs, "No machine code, as kernels get at their first launch");
  app.add_option("KERNEL", a->kernels, "NAME:FILE:PREFILTERED:SHARED_ORIGIN")->required();
  return [a] { run_compile(*a); };
}

}  // namespace dapple
