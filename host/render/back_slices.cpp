#include "render/back_slices.hpp"

#include "sampling/round.hpp"

namespace dapple {

BackSlices::BackSlices(DeviceContext& context, const Queues& front, std::uint32_t slice_samples,
                       const BackParams& choice)
    : context_(context),
      front_(front),
      queues_(front),
      slice_samples_(slice_samples),
      choice_(choice) {
  queues_.points = context.allocate(front.points.bytes());
  queues_.sample_hits = context.allocate(front.sample_hits.bytes());
}

bool BackSlices::fits(const SliceParams& next, std::span<const PixelWork> work) const {
  if (empty()) return true;
  const SliceParams& pending = choice_.resolve.slice;
  const std::uint32_t pixels = pending.pixel_count + next.pixel_count;
  return work.data() == work_.data() &&
         next.first_work == pending.first_work + pending.pixel_count &&
         next.first_sample == pending.first_sample && next.sample_count == pending.sample_count &&
         groups_touched(next, work, choice_.group_bits) == choice_.slots &&
         samples_of(packed_slice(choice_)) % DAPPLE_HIT_BITS == 0 &&
         std::size_t{pixels} * choice_.slots <= slice_samples_ &&
         pixels <= max_entries(slice_samples_);
}

void BackSlices::add(const SliceParams& next, std::span<const PixelWork> work) {
  SliceParams pending = choice_.resolve.slice;
  choice_.first_packed = static_cast<uint>(samples_of(packed_slice(choice_)));
  choice_.slots = groups_touched(next, work, choice_.group_bits);
  choice_.resolve.slice = next;
  flip_points_pass(context_, front_, queues_, choice_);
  if (!pending.pixel_count)
    pending = next;
  else
    pending.pixel_count += next.pixel_count;
  choice_.resolve.slice = pending;
  work_ = work;
}

std::size_t BackSlices::bytes() const {
  return queues_.points.bytes() + queues_.sample_hits.bytes();
}

}  // namespace dapple
