// Lists the kernels that passes launch, so that they can be compiled ahead and checked.
#pragma once

#include <vector>

#include "dapple/options.hpp"
#include "dapple/scene.hpp"
#include "device/context.hpp"

namespace dapple {

/// A kernel and the items of its work-groups.
struct KernelShape {
  KernelName kernel;
  std::size_t group = 0;
};

/// Every kernel that any picture or query launches on this device.
std::vector<KernelShape> every_kernel(const DeviceContext& context);

/// The kernels that a picture with these options, camera and lights launches.
std::vector<KernelName> picture_kernels(const DeviceContext& context, const RenderOptions& options,
                                        const Camera& camera, const std::vector<Light>& lights,
                                        bool shaded = false);

/// What is measured at points.
struct PointQuery {
  int rays = 1;  ///< from each point
  Estimator estimator = Estimator::prefiltered;
  bool measures_bias = false;  ///< some rays are traced exactly, too
  bool ao = false;             ///< AO alone
  bool bent = false;           ///< AO with bent normals
  bool light = false;          ///< irradiance of lights
  bool given_rays = false;     ///< rays that the host makes
};

/// The kernels of a query. May name one twice.
std::vector<KernelName> point_kernels(const DeviceContext& context, const PointQuery& query);

}  // namespace dapple
