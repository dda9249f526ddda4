#include "device/driver_needs.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// With fewer files the ICD loader finds no driver, or PoCL no compiler.
constexpr rlim_t kFiles = 32;

/// PoCL compiles on threads, whose stacks are as large as the limit of the first.
constexpr rlim_t kStackBytes = rlim_t{1} << 20;

/// PoCL 3.1 and its compiler begin to work with 0.6 GB. With less than 0.2 GB the ICD loader finds
/// no driver.
constexpr rlim_t kAddressBytes = rlim_t{1} << 29;

/// PoCL's threads, the compilers' processes, and the program. The limit counts all that a user
/// runs.
constexpr rlim_t kProcesses = 8;

rlim_t limit_of(int resource) {
  rlimit limit{};
  return getrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0 ? limit.rlim_cur
                                                                          : RLIM_INFINITY;
}

bool is_in(std::string_view folders, const char* program) {
  while (!folders.empty()) {
    const std::size_t colon = folders.find(':');
    const std::string folder(folders.substr(0, colon));
    if (!folder.empty() && access((folder + "/" + program).c_str(), X_OK) == 0) return true;
    if (colon == std::string_view::npos) break;
    folders.remove_prefix(colon + 1);
  }
  return false;
}

}  // namespace

void check_process_limits() {
  if (const rlim_t files = limit_of(RLIMIT_NOFILE); files < kFiles) {
    throw Error(
        ErrorKind::failed,
        fmt::format("only {} files may be open here (ulimit -n), and OpenCL drivers need {} "
                    "to start",
                    files, kFiles));
  }
  if (const rlim_t stack = limit_of(RLIMIT_STACK); stack < kStackBytes) {
    throw Error(
        ErrorKind::failed,
        fmt::format("stacks may only have {} kB here (ulimit -s), and OpenCL drivers need {} "
                    "kB to compile kernels",
                    stack / 1024, kStackBytes / 1024));
  }
  if (const rlim_t processes = limit_of(RLIMIT_NPROC); processes < kProcesses && geteuid() != 0) {
    throw Error(ErrorKind::failed,
                fmt::format("only {} processes and threads may run here (ulimit -u), and OpenCL "
                            "drivers need {} and more",
                            processes, kProcesses));
  }
  for (const auto& [resource, option] : {std::pair{RLIMIT_AS, "-v"}, {RLIMIT_DATA, "-d"}}) {
    const rlim_t bytes = limit_of(resource);
    if (bytes >= kAddressBytes) continue;
    throw Error(
        ErrorKind::failed,
        fmt::format("the process may only have {} kB of memory here (ulimit {}), and OpenCL "
                    "drivers need {} kB and more",
                    bytes / 1024, option, kAddressBytes / 1024));
  }
}

void require_linker() {
  const char* path = std::getenv("PATH");
  if (path && is_in(path, "ld")) return;
  throw Error(ErrorKind::device,
              fmt::format("PoCL links kernels with the program ld, which is not in PATH ({}); add "
                          "its folder, for example /usr/bin; Debian has it in binutils",
                          !path   ? "not set"
                          : *path ? path
                                  : "empty"));
}

}  // namespace dapple
