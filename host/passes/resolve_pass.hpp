// The resolve passes: add a slice's samples to the film. In: surface points, rays and occlusions.
// Out: sums and squares of the film's planes.
#pragma once

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

inline const KernelName kResolveSurface{"resolve_surface", "queue_kernels", {}};
inline const KernelName kResolveAo{"resolve_ao", "queue_kernels", {}};
inline const KernelName kResolveLight{"resolve_light", "queue_kernels", {}};
inline const KernelName kResolveDome{"resolve_dome", "lights/dome", {}};

/// Coverage, depth, normals and camera costs.
void resolve_surface_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                          const ResolveParams& params);
void resolve_ao_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                     const ResolveParams& params);
void resolve_light_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                        const ResolveParams& params);

/// As resolve_light_pass() for a dome: three channels, see resolve_dome in kernels/lights/dome.cl.
void resolve_dome_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                       const FilmBuffers& film, const ResolveParams& params, uint light);

}  // namespace dapple
