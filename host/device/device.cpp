// Implements Device of dapple/device.hpp: lists the usable OpenCL devices and opens one. In: part
// of a device's name. Out: descriptions of devices, a Device, or an Error.
#include "dapple/device.hpp"

#include "device/context.hpp"
#include "device/platforms.hpp"

namespace dapple {

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const cl::Device& device : usable_devices()) infos.push_back(describe(device));
  return infos;
}

Device::Device(const std::string& name, const std::string& kernel_dir, Packets packets)
    : context_(std::make_shared<DeviceContext>(name, kernel_dir, packets)) {}

const DeviceInfo& Device::info() const { return context_->info(); }

void Device::keep_compiled() const { context_->keep_compiled(); }

}  // namespace dapple
