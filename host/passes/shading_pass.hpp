// The shading pass: surface points get what their meshes say about the surface. In: points that the
// camera pass stored with their triangles. Out: points with shading normals, sums of the film.
#pragma once

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

/// The kernel that shading_pass() and move_points_pass() run.
KernelName shading_kernel(const DeviceContext& context);

/// Comes after resolve_surface_pass(), because it moves points to where their rays start. `spp`:
/// samples a pixel that footprints are computed for. `from`: where the points were seen from.
/// Throws Error usage for a queue of albedos and a scene without colours: nothing would fill it.
void shading_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                  const FilmBuffers& film, const ResolveParams& params, const Viewpoint& from,
                  int spp);

/// As shading_pass() for the first `samples` points, but adds nothing to a film. For scenes with
/// normals.
void move_points_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                      const Viewpoint& from, std::size_t samples);

}  // namespace dapple
