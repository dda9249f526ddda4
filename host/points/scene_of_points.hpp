// The scene of measure_points(), on the device. In: a scene and options. Out: the scene with
// opacities, copies (--periodic) and ground applied, its BVH, and the uploaded scene.
#pragma once

#include <utility>

#include "dapple/points.hpp"
#include "device/programs/kernels_ahead.hpp"
#include "passes/kernel_list.hpp"
#include "points/periodic.hpp"
#include "points/point_sets.hpp"

namespace dapple {

struct SceneOfPoints {
  SceneOfPoints(Scene given, const PointOptions& options)
      : device(options.device, options.kernel_dir), scene(std::move(given)) {
    for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
    finalize_domes(scene);
    const PointQuery query{options.rays / kPointSets, options.estimator, true,
                           options.ao || options.sky_view_factor,
                           (options.lights && !scene.lights.empty()) || !options.suns.empty()};
    KernelsAhead kernels(device.context(), point_kernels(device.context(), query));
    if (options.period_x > 0) repeat(scene, options.period_x, options.period_z);
    if (options.ground) add_ground(scene);
    merge_single_instances(scene);
    bvh = build_bvh(scene, options.cache);
    uploaded = upload(device, scene, bvh);
    kernels.finish();
  }

  Device device;
  Scene scene;
  SceneBvh bvh;
  DeviceScene uploaded;
};

}  // namespace dapple
