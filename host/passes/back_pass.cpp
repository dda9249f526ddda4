#include "passes/back_pass.hpp"

namespace dapple {

void turn_points_pass(DeviceContext& context, const Queues& queues, const Queues& backs,
                      const FilmBuffers& film, const BackParams& params) {
  const SliceParams& slice = params.resolve.slice;
  const std::size_t records = hit_records(std::size_t{slice.pixel_count} * slice.sample_count);
  context.launch(kTurnPoints, "shading", records,
                 {queues.points, queues.sample_hits, backs.points, backs.sample_hits, params},
                 kRayGroup);
  context.launch(kCountBacks, "resolve", slice.pixel_count,
                 {queues.work, backs.sample_hits, film.sums, params}, kRayGroup);
}

}  // namespace dapple
