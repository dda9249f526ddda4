// dapple compile: what CompilerProcesses starts. Not for users, who find nothing of it in --help.
#include "command/command.hpp"
#include "device/compiler_processes.hpp"
#include "device/context.hpp"
#include "wavefront/rehearsal.hpp"

namespace dapple {
namespace {

struct CompileArguments {
  std::string device, kernel_dir;
  bool programs = false;
  std::vector<std::string> kernels;
};

void run_compile(const CompileArguments& a) {
  std::vector<KernelName> kernels;
  for (const std::string& text : a.kernels) kernels.push_back(parse_kernel(text));
  const Device device(a.device, a.kernel_dir);
  if (!a.programs) return rehearse(device, kernels);
  for (const KernelName& kernel : kernels) device.context().prepare(kernel);
}

}  // namespace

Run add_compile_command(CLI::App& app) {
  auto a = std::make_shared<CompileArguments>();
  app.group("");
  app.add_option("--device", a->device, "Part of an OpenCL device's name");
  app.add_option("--kernel-dir", a->kernel_dir, "Read OpenCL kernels from this folder");
  app.add_flag("--programs", a->programs, "No machine code, as kernels get at their first launch");
  app.add_option("KERNEL", a->kernels, "NAME/FILE/PREFILTERED/ONE_POINT")->required();
  return [a] { run_compile(*a); };
}

}  // namespace dapple
