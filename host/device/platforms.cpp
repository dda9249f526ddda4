#include "device/platforms.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <tuple>

#include "device/cpus.hpp"
#include "device/driver_needs.hpp"
#include "device/environment_while.hpp"
#include "device/programs/kernel_cache.hpp"
#include "device/refused_drivers.hpp"

namespace dapple {
namespace {

/// The value of HWLOC_SYNTHETIC: memory and CPUs of the machine. Without /sys, as in some
/// containers, hwloc tells PoCL of no memory, and PoCL aborts the process. Empty when /sys exists
/// or the user has told hwloc otherwise.
std::string machine_for_hwloc() {
  std::error_code ignored;
  if (std::filesystem::exists("/sys/devices/system/cpu", ignored)) return {};
  for (const char* told_otherwise : {"HWLOC_SYNTHETIC", "HWLOC_XMLFILE", "HWLOC_FSROOT"}) {
    if (std::getenv(told_otherwise)) return {};
  }
  const auto bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                     static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return fmt::format("numa:1(memory={}) pu:{}", bytes,
                     std::max(1u, std::thread::hardware_concurrency()));
}

/// The value of POCL_AFFINITY. "1" binds each of PoCL's threads to its own CPU, by number: unbound
/// threads that wake together often share one CPU while another is idle (experiment 704). Empty
/// when the user has set it, or has set the number of threads, which may leave CPUs to other
/// programs; or when this process may not use all CPUs.
std::string one_cpu_a_thread() {
  if (std::getenv("POCL_AFFINITY") || std::getenv("POCL_MAX_PTHREAD_COUNT")) return {};
  const std::vector<int> ours = cpus_of_process();
  const auto count = static_cast<long>(ours.size());
  const bool all = count > 0 && count == sysconf(_SC_NPROCESSORS_ONLN) && ours.back() == count - 1;
  return all ? "1" : "";
}

std::vector<cl::Platform> platforms() {
  std::vector<cl::Platform> found;
  try {
    cl::Platform::get(&found);
  } catch (const cl::Error&) {
    found.clear();  // without a configuration of the ICD loader there is no platform
  }
  return found;
}

bool is_usable(const cl::Device& device) {
  return device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() &&
         device.getInfo<CL_DEVICE_ENDIAN_LITTLE>();
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

/// Greater is better: GPUs, then CPUs, then the rest, Mesa's CPUs last. GPUs with memory of their
/// own come before those that have the host's, whose compute units are many and small; among equals
/// the number of units decides.
std::tuple<int, bool, unsigned> rank(const cl::Device& device) {
  const auto type = device.getInfo<CL_DEVICE_TYPE>();
  const bool on_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
  // Mesa traces on a CPU, too, but a hundred times slower than PoCL.
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const bool slow = on_cpu && trimmed(platform.getInfo<CL_PLATFORM_NAME>()) == kMesaPlatform;
  constexpr int kGpu = 3;
  const int kind = slow ? 0 : type & CL_DEVICE_TYPE_GPU ? kGpu : on_cpu ? 2 : 1;
  return {kind, kind == kGpu && has_own_memory(device),
          device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()};
}

bool is_pocl(const cl::Platform& platform) {
  return trimmed(platform.getInfo<CL_PLATFORM_NAME>()) == kPoclPlatform;
}

std::string no_platform() {
  const char* vendors = std::getenv("OCL_ICD_VENDORS");
  return std::string("no OpenCL platform found") +
         (vendors ? std::string(" where OCL_ICD_VENDORS points, ") + vendors
                  : std::string(" in /etc/OpenCL/vendors")) +
         "; install a driver, for the CPU: apt install pocl-opencl-icd";
}

/// Devices that can compile kernels, and why others are not used.
struct FoundDevices {
  std::vector<cl::Device> usable;
  std::vector<std::string> refusals;  ///< each once
};

void add_devices(const cl::Platform& platform, FoundDevices& found) {
  std::vector<cl::Device> devices;
  try {
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    for (const cl::Device& device : devices) {
      if (!is_usable(device)) continue;
      std::string refusal = driver_refusal(trimmed(platform.getInfo<CL_PLATFORM_NAME>()),
                                           trimmed(device.getInfo<CL_DRIVER_VERSION>()));
      if (refusal.empty())
        refusal = language_refusal(trimmed(device.getInfo<CL_DEVICE_NAME>()),
                                   device.getInfo<CL_DEVICE_OPENCL_C_VERSION>());
      if (refusal.empty()) {
        found.usable.push_back(device);
      } else if (std::find(found.refusals.begin(), found.refusals.end(), refusal) ==
                 found.refusals.end()) {
        found.refusals.push_back(refusal);
      }
    }
  } catch (const cl::Error&) {
    // A platform without devices reports an error, not an empty list.
  }
}

std::string no_device(const std::vector<cl::Platform>& found, const KernelCache& cache) {
  std::string names;
  for (const cl::Platform& platform : found)
    names += (names.empty() ? "" : ", ") + trimmed(platform.getInfo<CL_PLATFORM_NAME>());
  std::string message = "no OpenCL device can compile kernels; platforms without one: " + names;
  if (cache.folder().empty()) {
    message += "; PoCL has no folder to compile kernels in (" + cache.refusals() +
               "): let XDG_CACHE_HOME name one that can be written";
  } else if (!names.empty()) {
    message += "; PoCL needs /proc and some 0.8 GB of address space (ulimit -v)";
  }
  return message;
}

/// PoCL compiles kernels to files, the largest of about 700 kB. When it cannot write them, it
/// refuses the kernels without a reason, or ends the process. Throws Error failed when the limit of
/// file sizes is too low for it.
void check_file_limit(const cl::Device& device) {
  constexpr std::uint64_t kBytesNeeded = 2u << 20;
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur >= kBytesNeeded) return;
  if (!is_pocl(cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()))) return;
  throw Error(ErrorKind::failed,
              fmt::format("PoCL cannot compile kernels: files may not grow past {} bytes here "
                          "(ulimit -f), and it writes up to {}",
                          limit.rlim_cur, kBytesNeeded));
}

/// Best first. Throws Error device where none is usable.
FoundDevices find_devices() {
  check_process_limits();
  const DriverAtWork at_work("looking for devices");
  const KernelCache& cache = KernelCache::of_process();
  // PoCL reads these variables when its devices are first listed.
  const EnvironmentWhile cache_folder("POCL_CACHE_DIR", cache.folder().string());
  const EnvironmentWhile machine("HWLOC_SYNTHETIC", machine_for_hwloc());
  const EnvironmentWhile affinity("POCL_AFFINITY", one_cpu_a_thread());
  const auto all = platforms();
  if (all.empty()) throw Error(ErrorKind::device, no_platform());
  FoundDevices found;
  for (const cl::Platform& platform : all) {
    if (cache.folder().empty() && is_pocl(platform)) continue;  // its builds would fail or crash
    add_devices(platform, found);
  }
  renew_crash_reports();
  if (found.usable.empty())
    throw Error(ErrorKind::device,
                found.refusals.empty() ? no_device(all, cache) : found.refusals.front());
  std::stable_sort(found.usable.begin(), found.usable.end(),
                   [](const cl::Device& a, const cl::Device& b) { return rank(a) > rank(b); });
  return found;
}

}  // namespace

// The query is deprecated since OpenCL 2.0.
bool has_own_memory(const cl::Device& device) {
  cl_bool shared = CL_TRUE;
  clGetDeviceInfo(device(), CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof shared, &shared, nullptr);
  return !shared;
}

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
    info.largest_buffer_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    return info;
  });
}

std::vector<std::string> refused_drivers() { return find_devices().refusals; }

std::vector<cl::Device> usable_devices() { return find_devices().usable; }

// A name may be a part of another one: PoCL's begins with "pthread-" and has that of the CPU.
cl::Device choose_device(const std::string& name) {
  const FoundDevices devices = find_devices();
  for (const cl::Device& device : devices.usable) {
    if (describe(device).name != name) continue;
    check_file_limit(device);
    return device;
  }
  std::string list;
  for (const cl::Device& device : devices.usable) {
    const DeviceInfo info = describe(device);
    if (lower_case(info.name + "\n" + info.platform).find(lower_case(name)) != std::string::npos) {
      check_file_limit(device);
      return device;
    }
    list += (list.empty() ? "" : ", ") + ("'" + info.name + "' (" + info.platform + ")");
  }
  for (const std::string& refusal : devices.refusals) list += "; " + refusal;
  throw Error(ErrorKind::device,
              "no OpenCL device matches --device '" + name + "'; there are: " + list);
}

}  // namespace dapple
