#include "device/refused_drivers.hpp"

#include <cctype>

#include "device/platform_names.hpp"

namespace dapple {

std::string driver_refusal(const std::string& platform, const std::string& version) {
  // As in "3.0", "3.0-rc2" and "3.0+debian".
  const std::string bad = "3.0";
  const bool is_bad =
      version.starts_with(bad) &&
      (version.size() == bad.size() || std::isdigit(static_cast<unsigned char>(version[3])) == 0);
  if (platform != kPoclPlatform || !is_bad) return {};
  return "PoCL " + version +
         " is not used: it aborts while it compiles dapple's kernels, or does not end; install "
         "PoCL 3.1 or later (apt install pocl-opencl-icd), or Intel's runtime (pip install "
         "intel-opencl-rt)";
}

std::string language_refusal(const std::string& device, const std::string& opencl_c) {
  for (const char* old : {"OpenCL C 1.0", "OpenCL C 1.1"}) {
    if (opencl_c.starts_with(old))
      return device + " is not used: its driver compiles " + old +
             ", and dapple's kernels are OpenCL C 1.2; install a newer driver";
  }
  return {};
}

}  // namespace dapple
