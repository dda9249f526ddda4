// AO and bent normals at points: occlusion() of the library, and what bakes need beside it.
#pragma once

#include <vector>

#include "dapple/render.hpp"
#include "render/queries/shared_points.hpp"

namespace dapple {

struct PointOcclusion {
  std::vector<float> ao;  ///< as occlusion() returns it
  std::vector<V3f> bent;  ///< mean of transmittance times direction, world space; or empty
};

/// occlusion(), also of smooth surfaces, with bent normals if `bent`. These take rays through
/// queues, which is slower.
PointOcclusion point_occlusion(const Device& device, const DeviceScene& scene,
                               const QueryPoints& points, const OcclusionOptions& options,
                               bool bent, const RenderControl& control = {});

}  // namespace dapple
