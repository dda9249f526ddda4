// AO and bent normals at points: occlusion() of the library, and what bakes need beside it.
#pragma once

#include <span>
#include <vector>

#include "dapple/render.hpp"

namespace dapple {

struct PointOcclusion {
  std::vector<float> ao;  ///< as occlusion() returns it
  std::vector<V3f> bent;  ///< mean of transmittance times direction, world space; or empty
};

/// occlusion(), with bent normals if `bent`. These take rays through queues, which is slower.
PointOcclusion point_occlusion(const Device& device, const DeviceScene& scene,
                               std::span<const V3f> points, std::span<const V3f> normals,
                               const OcclusionOptions& options, bool bent,
                               const RenderControl& control = {});

}  // namespace dapple
