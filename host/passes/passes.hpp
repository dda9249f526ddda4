// The wavefront: kernels between queues, one function a pass, in the order they run.
#pragma once

#include "dapple/options.hpp"
#include "device/context.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/film_sums.hpp"

namespace dapple {

/// What consecutive rays of a queue have in common.
enum class RayOrder {
  any,       ///< groups of rays_per_point rays share an origin
  by_pixel,  ///< they start on neighbouring pixels: CPUs trace them in pixel packets
};

/// Rays a launch of queries, so that no launch trips a driver's watchdog.
inline constexpr std::size_t kQueryRays = 1u << 18;

/// Queues for one slice; sized once, reused by every slice.
struct Queues {
  Buffer work;          ///< PixelWork of camera_pass(), allocated by who makes pictures
  Buffer rays;          ///< Ray
  Buffer points;        ///< SurfacePoint, one a camera sample
  Buffer sample_hits;   ///< SampleHits, one for DAPPLE_HIT_BITS samples
  Buffer active;        ///< uint: samples that hit, in order
  Buffer active_count;  ///< uint
  Buffer occlusions;    ///< Occlusion, one a ray
  [[nodiscard]] std::size_t bytes() const;
};

Queues make_queues(DeviceContext& context, std::size_t samples, std::size_t rays_per_sample);

/// The same for point_ao_pass(), where only the rays of points that are worked on are in memory,
/// and `occlusions` are floats, one a point. `points` are the caller's.
Queues make_point_queues(DeviceContext& context, std::size_t points, std::size_t rays_per_point);

/// What passes resolve into.
struct FilmBuffers {
  Buffer sums;     ///< 64-bit fixed point planes as FilmLayout says
  Buffer squares;  ///< float planes, FilmLayout::squares: squared means of batches and of pairs
};

/// First surfaces of the slice's camera rays into `points` and `sample_hits`.
void camera_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                 const CameraParams& params);

/// First surface of each ray in `rays` into `points`.
void closest_hit_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                      std::size_t rays);

/// Fills `active` and places hits in `sample_hits`; returns how many samples hit. Waits for the
/// device.
std::uint32_t compact_pass(DeviceContext& context, const Queues& queues, std::size_t samples);

void ao_ray_pass(DeviceContext& context, const Queues& queues, const AoParams& params);

void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params);

/// Transmittance of each ray in `rays` into `occlusions`. On CPUs in point packets, where
/// `params.rays_per_point` is large enough for that to pay, else in pixel packets; on other devices
/// as single rays, unless the device was opened with other packets.
void occlusion_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                    const std::string& label, Estimator estimator, const OcclusionParams& params,
                    RayOrder order = RayOrder::any);

/// The same with the given ray packets.
void occlusion_pass_with(Packets with, DeviceContext& context, const Queues& queues,
                         const DeviceBuffers& scene, const std::string& label, Estimator estimator,
                         const OcclusionParams& params);

/// Whether AO rays of points are generated, traced and averaged by one kernel without queues: on
/// CPUs, with point packets, where one batch holds a point's rays.
bool at_once(const DeviceContext& context, Estimator estimator, std::size_t rays_per_point);

/// AO in [0,1] of the points in `points` into `occlusions`, where at_once() says so.
void point_ao_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                   Estimator estimator, const AoParams& ao_params, const OcclusionParams& params);

void resolve_surface_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                          const ResolveParams& params);
void resolve_ao_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                     const ResolveParams& params);
void resolve_light_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                        const ResolveParams& params);

/// As resolve_light_pass() for a dome: three channels, see DomePlanes in kernels/lights/dome.cl.
void resolve_dome_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                       const FilmBuffers& film, const ResolveParams& params, uint light);

/// A kernel and the items of its work-groups.
struct KernelShape {
  KernelName kernel;
  std::size_t group = 0;
};
/// Every kernel that any picture or query launches.
std::vector<KernelShape> every_kernel(const DeviceContext& context);

/// The packets of a picture's occlusion rays; `rays`: of each sample.
Packets packets_in_picture(const DeviceContext& context, Estimator estimator, int rays);

/// The kernels that a picture with these options, camera and lights launches.
std::vector<KernelName> picture_kernels(const DeviceContext& context, const RenderOptions& options,
                                        const Camera& camera, const std::vector<Light>& lights);

}  // namespace dapple
