// What a bake traces against: the scene, other occluders and the ground, built and uploaded. In:
// scenes and options. Out: an uploaded scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bake/inside/closed_geometry.hpp"
#include "dapple/bake.hpp"
#include "dapple/bvh.hpp"
#include "dapple/device.hpp"

namespace dapple {

struct OccluderScene {
  /// Throws Error usage, input, device or failed.
  OccluderScene(const Device& on, Scene scene, const BakeOptions& options,
                const std::vector<Scene>& others);

  Device device;
  SceneBvh bvh;
  DeviceScene uploaded;
  std::unique_ptr<ClosedGeometry> closed;  ///< of the same scene
  std::vector<Light> lights;  ///< as uploaded, without those that emit nothing; empty unless
                              ///< options.light
  double build_seconds = 0, upload_seconds = 0, kernel_seconds = 0;
  std::vector<std::string> notes;
};

/// The part of a scene that is one mesh, as it is in object space, with the textures that it uses.
Scene scene_of_mesh(const Scene& scene, std::size_t mesh);

}  // namespace dapple
