// Shared by the oracle tests: scenes from files, and scenes uploaded to a device.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "dapple/dapple.hpp"

namespace dapple::oracle {

inline std::string shared_scene(const std::string& name) {
  return std::string(DAPPLE_SHARED_SCENES) + "/" + name;
}

#define DAPPLE_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here: left out"

/// A birch of 95,084 triangles. Its leaves get the opacity of a real leaf.
inline Scene load_sapling() {
  Scene scene = load_scene(shared_scene("sapling_100k.glb"));
  override_opacity(scene, "leaf", 0.85f);
  return scene;
}

/// A pine from a game: cards of needles with a texture, alpha-blended.
inline Scene load_pine() { return load_scene(shared_scene("smallpine/scene.gltf")); }

/// The scene with single instances merged, as render() prepares it for the BVH.
inline Scene merged(Scene scene) {
  merge_single_instances(scene);
  return scene;
}

/// A scene with its BVH on a device, ready for tracing.
struct OnDevice {
  explicit OnDevice(const Scene& scene)
      : bvh(build_bvh(scene)), uploaded(upload(device, scene, bvh)) {}
  Device device;
  SceneBvh bvh;  ///< must outlive `uploaded`
  DeviceScene uploaded;
};

}  // namespace dapple::oracle
