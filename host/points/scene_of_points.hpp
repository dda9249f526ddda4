// The scene of measure_points(), on the device. In: a scene, with its copies (--periodic), and
// options. Out: the scene with opacities and ground applied, its BVH, and the uploaded scene.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "dapple/points.hpp"
#include "device/programs/kernels_ahead.hpp"
#include "passes/kernel_list.hpp"
#include "points/point_sets.hpp"
#include "render/stopwatch.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {

struct SceneOfPoints {
  SceneOfPoints(Scene given, const PointOptions& options)
      : device(options.device, options.kernel_dir), scene(std::move(given)) {
    check_scene(scene);
    for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
    finalize_domes(scene);
    KernelsAhead kernels(device.context(), kernels_of(device.context(), scene, options));
    if (options.ground) add_ground(scene);
    merge_single_instances(scene);
    const Stopwatch building;
    bvh = build_bvh(scene, options.cache);
    build_seconds = building.seconds();
    uploaded = upload(device, scene, bvh);
    kernels.finish();
  }

  static std::vector<KernelName> kernels_of(const DeviceContext& context, const Scene& scene,
                                            const PointOptions& options) {
    PointQuery query;
    query.estimator = options.estimator;
    query.measures_bias = options.footprint > 0;
    query.rays = options.rays / kPointSets;
    query.ao = options.sky_view_factor || (options.ao && !options.bent);
    query.bent = options.bent;
    query.light = options.lights && !scene.lights.empty();
    query.given_rays = options.rings > 0;
    std::vector<KernelName> kernels = point_kernels(context, query);
    if (!options.suns.empty()) {
      query.ao = query.bent = query.light = false;
      query.given_rays = true;
      query.rays =
          static_cast<int>(std::min(options.suns.size(), static_cast<std::size_t>(options.rays)));
      for (KernelName& kernel : point_kernels(context, query)) kernels.push_back(std::move(kernel));
    }
    return kernels;
  }

  Device device;
  Scene scene;
  SceneBvh bvh;
  DeviceScene uploaded;
  double build_seconds = 0;
};

}  // namespace dapple
