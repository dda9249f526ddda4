#include "scene_on_device.hpp"

#include <map>

namespace dapple::python {

namespace {

/// Never destroyed: drivers may be unloaded before static objects are.
std::map<std::string, Device>& open_devices() {
  static auto& devices = *new std::map<std::string, Device>;
  return devices;
}

}  // namespace

void keep_kernels() {
  for (const auto& [name, device] : open_devices()) device.keep_compiled();
}

Device open_device(const std::string& name) {
  auto& devices = open_devices();
  const auto found = devices.find(name);
  return found != devices.end() ? found->second : devices.emplace(name, Device(name)).first->second;
}

const Uploaded& SceneOnDevice::Query::upload() {
  if (uploaded) return *uploaded;
  auto made = std::make_shared<Uploaded>(Uploaded{open_device(device), *scene, {}, {}});
  finalize_domes(made->scene);
  merge_single_instances(made->scene);
  made->bvh = build_bvh(made->scene);
  made->on_device = dapple::upload(made->device, made->scene, made->bvh);
  uploaded = std::move(made);
  return *uploaded;
}

}  // namespace dapple::python
