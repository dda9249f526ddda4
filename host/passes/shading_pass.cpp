#include "passes/shading_pass.hpp"

namespace dapple {

void shading_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                  const FilmBuffers& film, const ResolveParams& params) {
  context.launch(kShadePoints, "shading", params.slice.pixel_count,
                 {scene.blocks, scene.instances, scene.normals, queues.work, queues.points,
                  queues.sample_hits, film.sums, params},
                 kRayGroup);
}

}  // namespace dapple
