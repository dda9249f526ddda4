// One scene as both sides have it: dapple's on its device, Embree's at both qualities, one camera.
#pragma once

#include "accuracy/picture_scene.hpp"
#include "camera/view.hpp"
#include "rivals/ao_points.hpp"
#include "rivals/embree_picture.hpp"

namespace dapple::bench {

struct RivalScene {
  /// Builds everything; dapple's BVH first. Throws Error.
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
  Device device;          ///< for rays and points; `ours` opens one of its own for pictures
  DeviceScene on_device;  ///< `ours`' BVH on it
};

}  // namespace dapple::bench
