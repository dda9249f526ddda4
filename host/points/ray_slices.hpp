// Traces rays that the host makes, slice by slice. In: a function that makes the rays of a point.
// Out: the transmittance of each ray.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "points/scene_of_points.hpp"

namespace dapple {

/// Rays that are traced at once.
inline constexpr std::size_t kRaysAtOnce = 1u << 20;

/// The same number of rays from each point, which share their origin.
struct RaysOfPoints {
  std::size_t points = 0, rays_per_point = 0;
  Estimator estimator = Estimator::prefiltered;
  float footprint = 1;
};

/// Calls make(point, rays), from several threads, to fill the rays of each point, and then
/// add(point, ray of the point, transmittance) in order, and step(points) after each slice. Returns
/// false if a step did.
template <class Make, class Add, class Step>
bool trace_slices(const SceneOfPoints& on, const RaysOfPoints& of, const Make& make, const Add& add,
                  const Step& step) {
  const std::size_t slice = std::max<std::size_t>(1, kRaysAtOnce / of.rays_per_point);
  std::vector<Ray> rays;
  for (std::size_t begin = 0; begin < of.points; begin += slice) {
    const std::size_t end = std::min(of.points, begin + slice);
    rays.resize((end - begin) * of.rays_per_point);
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      make(i, std::span<Ray>(&rays[(i - begin) * of.rays_per_point], of.rays_per_point));
    });
    const std::vector<Occlusion> found =
        trace(on.device, on.uploaded, rays, of.estimator, of.footprint, of.rays_per_point);
    for (std::size_t r = 0; r < found.size(); ++r)
      add(begin + r / of.rays_per_point, r % of.rays_per_point, double{found[r].transmittance});
    if (!step(end - begin)) return false;
  }
  return true;
}

}  // namespace dapple
