#include "passes/back_pass.hpp"

#include <algorithm>

#include "sampling/round.hpp"

namespace dapple {

uint groups_touched(const SliceParams& slice, std::span<const PixelWork> work, uint group_bits) {
  const uint last = (1u << group_bits) - 1u;
  const auto begins_group = [&](const PixelWork& entry) {
    return ((entry.first_sample + slice.first_sample) & last) == 0;
  };
  const auto entries = work.subspan(slice.first_work, slice.pixel_count);
  // Else the first sample may be the last of its group.
  const uint before = std::all_of(entries.begin(), entries.end(), begins_group) ? 0 : last;
  return (slice.sample_count + before + last) >> group_bits;
}

SliceParams packed_slice(const BackParams& choice) {
  SliceParams packed = choice.resolve.slice;
  packed.sample_count = choice.slots;
  return packed;
}

void flip_points_pass(DeviceContext& context, const Queues& queues, const Queues& backs,
                      const BackParams& choice) {
  context.launch(
      kFlipPoints, "shading", hit_records(samples_of(packed_slice(choice))),
      {queues.work, queues.points, queues.sample_hits, backs.points, backs.sample_hits, choice},
      kRayGroup);
}

void count_backs_pass(DeviceContext& context, const Queues& backs, const FilmBuffers& film,
                      const BackParams& choice) {
  context.launch(kCountBacks, "resolve", choice.resolve.slice.pixel_count,
                 {backs.work, backs.sample_hits, film.sums, choice}, kRayGroup);
}

}  // namespace dapple
