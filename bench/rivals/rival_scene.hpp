// One scene for both programs. In: a scene's name and options. Out: dapple's BVH on its device,
// Embree's BVHs at both qualities, and the camera that both use.
#pragma once

#include "accuracy/picture_scene.hpp"
#include "camera/view.hpp"
#include "rivals/embree/ao_points.hpp"
#include "rivals/embree/embree_picture.hpp"

namespace dapple::bench {

struct RivalScene {
  /// Builds both, dapple's BVH first. Throws Error.
  RivalScene(const std::string& scene_spec, const RenderOptions& render_options);
  RivalScene(const RivalScene&) = delete;
  RivalScene& operator=(const RivalScene&) = delete;

  std::string spec;
  RenderOptions options;
  PictureScene ours;
  View view;
  EmbreeGeometry geometry;
  EmbreeScenes embree;
  CameraRays camera;
  Device device;          ///< for rays and points; `ours` has its own for pictures
  DeviceScene on_device;  ///< `ours`' BVH on it
};

}  // namespace dapple::bench
