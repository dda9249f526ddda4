#include "device/programs/compiler_processes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <map>
#include <set>

#include "dapple/error.hpp"
#include "device/cpus.hpp"
#include "device/driver_needs.hpp"
#include "device/programs/kernel_source.hpp"

namespace dapple {
namespace {

/// Each process takes about 230 MB of memory.
constexpr std::size_t kMaxProcesses = 4;

using Arguments = std::vector<std::string>;

std::string& program_in_use() {
  static std::string program;
  return program;
}

/// Starts `program` with standard input, output and error at /dev/null. Returns the process id, or
/// 0 when it cannot be started.
pid_t start_process(const std::string& program, Arguments arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  if (posix_spawn_file_actions_init(&files) != 0) return 0;
  for (const int descriptor : {0, 1, 2})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  pid_t process = 0;
  if (posix_spawn(&process, program.c_str(), &files, nullptr, argv.data(), environ) != 0)
    process = 0;
  posix_spawn_file_actions_destroy(&files);
  return process;
}

/// A kernel whose source cannot be read counts as compiled here: DeviceContext::prepare() throws
/// the error later.
bool is_missing(const DeviceContext& context, const KernelName& kernel, CompileTo to) {
  try {
    return !context.is_compiled(kernel, to);
  } catch (const Error&) {
    return false;
  }
}

/// Kernels that one process compiles. Those of one program stay together, because a program is
/// compiled as a whole.
struct Batch {
  std::size_t source_size = 0;  ///< bytes: about proportional to the time of compiling
  std::vector<KernelName> kernels;
};

/// The missing kernels, in one batch for each program.
std::vector<Batch> by_program(const DeviceContext& context, const std::set<KernelName>& kernels,
                              CompileTo to) {
  std::map<std::pair<std::string, Variant>, Batch> programs;
  for (const KernelName& kernel : kernels) {
    if (!is_missing(context, kernel, to)) continue;
    const std::string file = kernel.source_file();
    Batch& batch = programs[{file, kernel.variant}];
    if (batch.kernels.empty()) batch.source_size = expand_kernel(file, context.kernel_dir()).size();
    batch.kernels.push_back(kernel);
  }
  std::vector<Batch> batches;
  for (auto& [program, batch] : programs) batches.push_back(std::move(batch));
  return batches;
}

/// Merges the programs into at most `count` batches with sources of about the same size: from the
/// largest program to the smallest, each joins the batch that is smallest so far.
std::vector<Batch> distribute(std::vector<Batch> programs, std::size_t count) {
  const auto less = [](const Batch& a, const Batch& b) { return a.source_size < b.source_size; };
  std::vector<Batch> batches(std::min(count, programs.size()));
  std::stable_sort(programs.rbegin(), programs.rend(), less);
  for (const Batch& program : programs) {
    Batch& batch = *std::min_element(batches.begin(), batches.end(), less);
    batch.source_size += program.source_size;
    batch.kernels.insert(batch.kernels.end(), program.kernels.begin(), program.kernels.end());
  }
  return batches;
}

}  // namespace

std::string text_of(const KernelName& kernel) {
  return fmt::format("{}:{}:{:d}:{:d}", kernel.name, kernel.file, kernel.variant.prefiltered,
                     kernel.variant.shared_origin);
}

KernelName parse_kernel(const std::string& text) {
  char name[64], file[64];
  int prefiltered = 0, shared_origin = 0, end = 0;
  if (std::sscanf(text.c_str(), "%63[a-z_]:%63[a-z_/]:%1d:%1d%n", name, file, &prefiltered,
                  &shared_origin, &end) != 4 ||
      static_cast<std::size_t>(end) != text.size())
    throw Error(ErrorKind::usage, "no kernel: '" + text + "'");
  return {name, file, {prefiltered != 0, shared_origin != 0}};
}

void CompilerProcesses::use(const std::string& program) { program_in_use() = program; }

CompilerProcesses::~CompilerProcesses() {
  for (const pid_t process : running_) kill(process, SIGKILL);
  wait();
}

void CompilerProcesses::start(const DeviceContext& context, const std::vector<KernelName>& kernels,
                              CompileTo to) {
  if (program_in_use().empty() || !context.keeps_compiled()) return;
  const std::size_t cpus = cpus_of_process().size();
  if (cpus < 2) return;  // parallel processes would gain nothing
  Arguments common{"dapple", "compile", "--parent", std::to_string(getpid())};
  if (to == CompileTo::programs) common.emplace_back("--programs");
  const auto add_option = [&](const char* name, const std::string& value) {
    if (!value.empty()) common.insert(common.end(), {name, value});
  };
  add_option("--device", context.chosen_by());
  add_option("--kernel-dir", context.kernel_dir());
  add_option("--packets", context.packets() == Packets::scalar ? "scalar" : "");
  const auto programs = by_program(context, {kernels.begin(), kernels.end()}, to);
  if (!programs.empty()) require_linker();
  for (const Batch& batch : distribute(programs, std::min(cpus, kMaxProcesses))) {
    Arguments arguments = common;
    for (const KernelName& kernel : batch.kernels) arguments.push_back(text_of(kernel));
    if (const pid_t process = start_process(program_in_use(), std::move(arguments)))
      running_.push_back(process);
  }
}

void CompilerProcesses::wait() {
  for (const pid_t process : running_) {
    while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  running_.clear();
}

}  // namespace dapple
