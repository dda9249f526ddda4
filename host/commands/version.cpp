// dapple --version, and with --verbose what a report of a bug should say: how the program was
// built, and which device libraries it finds.
#include <fmt/format.h>
#include <link.h>

#include <string>
#include <vector>

#include "commands/command.hpp"
#include "commands/tell.hpp"
#include "dapple/device.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Collects the paths of loaded libraries that make and run kernels.
int add_device_library(dl_phdr_info* info, std::size_t, void* found) {
  const std::string path = info->dlpi_name;
  for (const char* part : {"OpenCL", "opencl", "intelocl", "pocl", "LLVM", "clang"})
    if (path.find(part) != std::string::npos) {
      static_cast<std::vector<std::string>*>(found)->push_back(path);
      break;
    }
  return 0;
}

void print_devices() {
  try {
    for (const DeviceInfo& device : list_devices())
      put("device: {}; {}, driver {}\n", device.name, device.platform, device.driver);
  } catch (const Error& error) {
    put("device: none; {}\n", error.what());
  }
  std::vector<std::string> libraries;
  dl_iterate_phdr(add_device_library, &libraries);
  for (const std::string& path : libraries) put("device library: {}\n", path);
}

}  // namespace

void print_version(bool verbose) {
  put("dapple {}\n", DAPPLE_VERSION);
  if (!verbose) return;
  put("build: {}\ncompiler: {}\n", DAPPLE_BUILD, DAPPLE_COMPILER);
  put("libraries: fmt {}.{}.{}, CLI11 {}\n", FMT_VERSION / 10000, FMT_VERSION / 100 % 100,
      FMT_VERSION % 100, CLI11_VERSION);
  print_devices();
}

}  // namespace dapple
