// Irradiance at points: irradiance() of the library, also of smooth surfaces, which bakes need.
#pragma once

#include <vector>

#include "dapple/render.hpp"
#include "render/queries/shared_points.hpp"

namespace dapple {

/// irradiance() at the points of `points`.
std::vector<PointIrradiance> point_irradiance(const Device& device, const DeviceScene& scene,
                                              std::span<const Light> lights,
                                              const QueryPoints& points,
                                              const IrradianceOptions& options,
                                              const RenderControl& control = {});

}  // namespace dapple
