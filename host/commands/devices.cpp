// dapple devices: lists the OpenCL devices, best first; with --check also whether each can run
// dapple.
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "commands/command.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "device/refused_drivers.hpp"

namespace dapple {
namespace {

const char* describe(Packets packets) {
  switch (packets) {
    case Packets::pixel:
      return "occlusion rays in pixel packets, from 16 rays per point (exact: 32) in point packets";
    case Packets::point:
      return "occlusion rays in point packets";
    case Packets::scalar:
      return "each ray in a work-item of its own, one box or triangle at a time";
    default:
      return "single occlusion rays";
  }
}

void print_device(const DeviceInfo& info) {
  put("{}\n  {} ({}), driver {}, {} compute units, {}\n", info.name, info.kind, info.platform,
      info.driver, info.compute_units, bytes_text(static_cast<double>(info.memory_bytes)));
  put_now();
}

/// Whether the device can run every kernel.
bool print_check(const DeviceCheck& check) {
  for (const std::string& refusal : check.refusals) put("  cannot be used: {}\n", refusal);
  if (check.refusals.empty()) put("  runs every kernel; {}\n", describe(check.packets));
  return check.refusals.empty();
}

struct DevicesArguments {
  std::string kernel_dir;
  bool check = false;
};

void run_devices(const DevicesArguments& a) {
  bool one_will_do = !a.check;
  for (const DeviceInfo& info : list_devices()) {
    print_device(info);
    if (!a.check) continue;
    DeviceCheck check;
    tell("compiling every kernel for {}\n", info.name);
    try {
      check = check_device(Device(info.name, a.kernel_dir));
    } catch (const Error& error) {
      check.refusals.emplace_back(error.what());
    }
    one_will_do = print_check(check) || one_will_do;
  }
  for (const std::string& refusal : refused_drivers()) put("{}\n", refusal);
  if (!one_will_do)
    throw Error(ErrorKind::device, "no OpenCL device can run every kernel; the reasons are above");
}

}  // namespace

Run add_devices_command(CLI::App& app) {
  auto a = std::make_shared<DevicesArguments>();
  CLI::Option& check = *app.add_flag(
      "--check", a->check,
      "Compile every kernel, and say whether each device can run them; may take minutes");
  app.add_option("--kernel-dir", a->kernel_dir,
                 "Read OpenCL kernels from this folder (for developers)")
      ->needs(&check);
  app.footer(
      "Example:\n  dapple devices\n\ndapple uses the first device; --device NAME chooses another. "
      "render --packets changes how its rays are grouped.");
  return [a] { run_devices(*a); };
}

}  // namespace dapple
