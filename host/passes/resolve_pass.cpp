#include "passes/resolve_pass.hpp"

namespace dapple {

void resolve_surface_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                          const ResolveParams& params) {
  context.launch(kResolveSurface, "resolve", params.slice.pixel_count,
                 {queues.work, queues.points, queues.sample_hits, film.sums, params});
}

void resolve_ao_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                     const ResolveParams& params) {
  context.launch(kResolveAo, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, queues.albedo,
                  film.sums, film.squares, params});
}

void resolve_light_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                        const ResolveParams& params) {
  context.launch(kResolveLight, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, queues.albedo,
                  film.sums, film.squares, params});
}

void resolve_dome_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                       const FilmBuffers& film, const ResolveParams& params, uint light) {
  context.launch(kResolveDome, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, queues.albedo,
                  scene.lights, scene.environments, film.sums, film.squares, params, light});
}

}  // namespace dapple
