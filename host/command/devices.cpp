// dapple devices: what OpenCL offers here, best first.
#include <fmt/format.h>

#include "command/command.hpp"
#include "command/statistics_text.hpp"
#include "dapple/device.hpp"

namespace dapple {

Run add_devices_command(CLI::App& app) {
  app.footer(
      "Example:\n  dapple devices\n\nThe first is used unless --device names part of another's "
      "name.");
  return [] {
    for (const DeviceInfo& info : list_devices()) {
      fmt::print("{}\n  {} ({}), driver {}, {} compute units, {}\n", info.name, info.kind,
                 info.platform, info.driver, info.compute_units,
                 bytes_text(static_cast<double>(info.memory_bytes)));
    }
  };
}

}  // namespace dapple
