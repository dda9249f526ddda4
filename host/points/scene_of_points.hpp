// The scene of measure_points(), on the device. In: a scene and options. Out: the scene with
// opacities, copies (--periodic) and ground applied, its BVH, and the uploaded scene.
#pragma once

#include <utility>

#include "dapple/points.hpp"
#include "points/periodic.hpp"

namespace dapple {

struct SceneOfPoints {
  SceneOfPoints(Scene given, const PointOptions& options)
      : device(options.device, options.kernel_dir), scene(std::move(given)) {
    for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
    finalize_domes(scene);
    if (options.period_x > 0) repeat(scene, options.period_x, options.period_z);
    if (options.ground) add_ground(scene);
    merge_single_instances(scene);
    bvh = build_bvh(scene, options.cache);
    uploaded = upload(device, scene, bvh);
  }

  Device device;
  Scene scene;
  SceneBvh bvh;
  DeviceScene uploaded;
};

}  // namespace dapple
