// dapple devices: lists the OpenCL devices, best first, and whether each can run dapple.
#include <fmt/format.h>

#include "commands/command.hpp"
#include "commands/statistics_text.hpp"
#include "dapple/error.hpp"
#include "dapple/render.hpp"

namespace dapple {
namespace {

const char* describe(Packets packets) {
  switch (packets) {
    case Packets::pixel:
      return "occlusion rays in pixel packets, from 16 rays per point (exact: 32) in point packets";
    case Packets::point:
      return "occlusion rays in point packets";
    default:
      return "single occlusion rays";
  }
}

/// Whether the device can run every kernel.
bool print_device(const DeviceInfo& info, const DeviceCheck& check) {
  fmt::print("{}\n  {} ({}), driver {}, {} compute units, {}\n", info.name, info.kind,
             info.platform, info.driver, info.compute_units,
             bytes_text(static_cast<double>(info.memory_bytes)));
  for (const std::string& refusal : check.refusals) fmt::print("  cannot be used: {}\n", refusal);
  if (check.refusals.empty()) fmt::print("  runs every kernel; {}\n", describe(check.packets));
  return check.refusals.empty();
}

void run_devices(const std::string& kernel_dir) {
  bool one_will_do = false;
  for (const DeviceInfo& info : list_devices()) {
    DeviceCheck check;
    try {
      check = check_device(Device(info.name, kernel_dir));
    } catch (const Error& error) {
      check.refusals.emplace_back(error.what());
    }
    one_will_do = print_device(info, check) || one_will_do;
  }
  if (!one_will_do)
    throw Error(ErrorKind::device, "no OpenCL device can run every kernel; the reasons are above");
}

}  // namespace

Run add_devices_command(CLI::App& app) {
  auto kernel_dir = std::make_shared<std::string>();
  app.add_option("--kernel-dir", *kernel_dir,
                 "Read OpenCL kernels from this folder (for developers)");
  app.footer(
      "Example:\n  dapple devices\n\ndapple uses the first device; --device NAME chooses another. "
      "render --packets changes how its rays are grouped.");
  return [kernel_dir] { run_devices(*kernel_dir); };
}

}  // namespace dapple
