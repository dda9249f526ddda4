#include "render/hit_sums.hpp"

#include <tbb/parallel_for.h>

#include <bit>

namespace dapple {

HitSums::HitSums(const HitLookups& lookups, std::size_t pixels, std::uint32_t first_sample)
    : mattes(lookups.mattes ? pixels : 0, first_sample > 0 ? kAnyMatteSlots : kMaxMatteSlots),
      motion(lookups.motion ? pixels : 0),
      deep(lookups.deep ? pixels : 0),
      lookups_(lookups),
      pixels_(pixels) {}

void HitSums::take_from(TraceState& state) {
  if (lookups_.mattes && !state.mattes.empty()) mattes.unpack(state.mattes, pixels_);
  if (!state.motion.empty()) motion = std::move(state.motion);
  if (!state.deep.empty()) deep = std::move(state.deep);
}

void HitSums::copy_to(TraceState& state) const {
  if (lookups_.mattes) state.mattes = mattes.packed();
  state.motion = motion;
  state.deep = deep;
}

void HitSums::add(const SliceParams& slice, std::span<const PixelWork> work,
                  std::span<const SurfacePoint> points, std::span<const SampleHits> hits,
                  const ResolveParams& view) {
  tbb::parallel_for(0u, slice.pixel_count, [&](uint entry) {
    const PixelWork& of_pixel = work[slice.first_work + entry];
    const uint begin = entry * slice.sample_count, end = begin + slice.sample_count;
    const uint first_sample = of_pixel.first_sample + slice.first_sample;
    for (uint record = begin / DAPPLE_HIT_BITS; record * DAPPLE_HIT_BITS < end; ++record) {
      for (uint left = hits[record].hits; left; left &= left - 1) {
        const uint i = record * DAPPLE_HIT_BITS + static_cast<uint>(std::countr_zero(left));
        if (i < begin || i >= end) continue;  // of another pixel
        add_hit(of_pixel.pixel, first_sample + i - begin, points[i], view);
      }
    }
  });
}

/// The point still has what the camera pass kept for the shading pass.
void HitSums::add_hit(uint pixel, uint sample, const SurfacePoint& point,
                      const ResolveParams& view) {
  const uint instance = std::bit_cast<uint>(point.t), primitive = point.visits;
  const float* at = point.position;
  if (lookups_.mattes) {
    const auto ids = lookups_.mattes->at(instance, primitive);
    mattes.add(pixel, ids.object, ids.material, sample);
  }
  if (lookups_.motion)
    motion.add(pixel, lookups_.motion->at(instance, primitive, {at[0], at[1], at[2]}));
  if (!lookups_.deep) return;
  float depth = 0;
  for (int axis = 0; axis < 3; ++axis) depth += (at[axis] - view.eye[axis]) * view.axis[axis];
  deep.add(pixel, depth);
}

}  // namespace dapple
