// AO from points by Embree, as a baker would write it: rays of many points side by side in
// batches, points over threads.
#pragma once

#include <span>
#include <vector>

#include "rivals/camera_rays.hpp"
#include "rivals/embree_trace.hpp"
#include "rivals/surface.hpp"

namespace dapple::bench {

/// Roundings by which dapple::occlusion() starts rays off their points; Embree's do as well.
inline constexpr float kPointRoundings = 4e-6f * 0x1p24f;

/// What the camera sees through stratified places of every pixel, one sample each, by tiles of
/// 8x8 pixels; evenly thinned to `most`.
std::vector<Surface> visible_points(const EmbreeScenes& scenes, const CameraRays& camera,
                                    std::size_t most);

/// Writes rays `first`... of all `rays` * points rays, point by point, until the batch is full
/// or there are no more.
void fill_ao_rays(std::span<const Surface> points, std::size_t rays, std::size_t first,
                  std::uint32_t seed, RayBatch& batch);

/// Ambient occlusion of each point: the mean transmittance of a set of `rays` cosine-weighted
/// rays. 1 = unoccluded.
std::vector<double> embree_occlusion(const EmbreeScenes& scenes, const EmbreeMethod& method,
                                     std::span<const Surface> points, std::size_t rays,
                                     std::uint32_t seed, float black);

}  // namespace dapple::bench
