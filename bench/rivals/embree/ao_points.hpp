// AO at points by Embree: batches hold rays of many points, and threads share the points. In:
// scenes and points. Out: the AO of each point.
#pragma once

#include <span>
#include <vector>

#include "rivals/embree/camera_rays.hpp"
#include "rivals/embree/embree_trace.hpp"
#include "rivals/embree/surface.hpp"

namespace dapple::bench {

/// Offset of ray origins from their points, in roundings (ray_start()): that of
/// dapple::occlusion().
inline constexpr float kPointRoundings = 4e-6f * 0x1p24f;

/// The points that camera rays hit, one stratified ray per pixel, in tiles of 8x8 pixels. If there
/// are more than `most`, returns `most` of them at regular intervals.
std::vector<Surface> visible_points(const EmbreeScenes& scenes, const CameraRays& camera,
                                    std::size_t most);

/// Fills the batch with AO rays, beginning with ray `first` of all: ray number point * `rays` + i
/// is ray i of the point. Stops when the batch is full or after the last ray.
void fill_ao_rays(std::span<const Surface> points, std::size_t rays, std::size_t first,
                  std::uint32_t seed, RayBatch& batch);

/// Ambient occlusion of each point: the mean transmittance of a set of `rays` cosine-weighted
/// rays. 1 = unoccluded.
std::vector<double> embree_occlusion(const EmbreeScenes& scenes, const EmbreeMethod& method,
                                     std::span<const Surface> points, std::size_t rays,
                                     std::uint32_t seed, float black);

}  // namespace dapple::bench
