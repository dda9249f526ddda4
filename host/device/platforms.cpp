#include "device/platforms.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>

namespace dapple {
namespace {

/// PoCL 3.1 aborts the process on a damaged kernel cache: it gets a folder of its own
/// instead of one shared with every other program. An explicit POCL_CACHE_DIR is kept.
void give_pocl_a_private_cache() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (!variable("POCL_CACHE_DIR").empty()) return;
  std::filesystem::path folder = variable("XDG_CACHE_HOME");
  if (folder.empty() && !variable("HOME").empty())
    folder = std::filesystem::path(variable("HOME")) / ".cache";
  if (folder.empty()) folder = std::filesystem::temp_directory_path();
  folder = folder / "dapple" / "pocl";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) setenv("POCL_CACHE_DIR", folder.c_str(), 0);
}

std::vector<cl::Platform> platforms() {
  give_pocl_a_private_cache();
  std::vector<cl::Platform> found;
  try {
    cl::Platform::get(&found);
  } catch (const cl::Error&) {
    found.clear();  // no ICD loader configuration at all is the same as no platform
  }
  return found;
}

bool is_usable(const cl::Device& device) {
  return device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() &&
         device.getInfo<CL_DEVICE_ENDIAN_LITTLE>();
}

/// GPUs before CPUs before the rest; more compute units first.
std::pair<int, unsigned> rank(const cl::Device& device) {
  const auto type = device.getInfo<CL_DEVICE_TYPE>();
  const int kind = type & CL_DEVICE_TYPE_GPU ? 2 : type & CL_DEVICE_TYPE_CPU ? 1 : 0;
  return {kind, device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()};
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string trimmed(std::string text) {
  while (!text.empty() &&
         (text.back() == '\0' || std::isspace(static_cast<unsigned char>(text.back()))))
    text.pop_back();
  return text;
}

}  // namespace

DeviceInfo describe(const cl::Device& device) {
  return in_opencl("asking a device for its properties", [&] {
    DeviceInfo info;
    info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
    info.platform =
        trimmed(cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>());
    info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
    const auto type = device.getInfo<CL_DEVICE_TYPE>();
    info.kind = type & CL_DEVICE_TYPE_GPU   ? "GPU"
                : type & CL_DEVICE_TYPE_CPU ? "CPU"
                                            : "accelerator";
    info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    info.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    return info;
  });
}

std::vector<cl::Device> usable_devices() {
  const auto found = platforms();
  if (found.empty()) {
    throw Error(
        ErrorKind::device,
        "no OpenCL platform found; install a driver, for the CPU: apt install pocl-opencl-icd");
  }
  std::vector<cl::Device> usable;
  for (const cl::Platform& platform : found) {
    std::vector<cl::Device> devices;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    } catch (const cl::Error&) {
      continue;  // a platform without devices reports an error, not an empty list
    }
    std::copy_if(devices.begin(), devices.end(), std::back_inserter(usable), is_usable);
  }
  if (usable.empty()) {
    throw Error(
        ErrorKind::device,
        "there are OpenCL platforms but none has a device that can compile kernels; in a container "
        "PoCL needs /sys and /proc mounted");
  }
  std::stable_sort(usable.begin(), usable.end(),
                   [](const cl::Device& a, const cl::Device& b) { return rank(a) > rank(b); });
  return usable;
}

cl::Device choose_device(const std::string& name) {
  const auto devices = usable_devices();
  std::string list;
  for (const cl::Device& device : devices) {
    const DeviceInfo info = describe(device);
    if (lower_case(info.name + "\n" + info.platform).find(lower_case(name)) != std::string::npos)
      return device;
    list += (list.empty() ? "" : ", ") + ("'" + info.name + "' (" + info.platform + ")");
  }
  throw Error(ErrorKind::device,
              "no OpenCL device matches --device '" + name + "'; there are: " + list);
}

}  // namespace dapple
