#include "rivals/embree/alpha_filter.hpp"

#include <bit>

#include "rivals/embree/opacity_table.hpp"
#include "rivals/embree/stratified.hpp"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace dapple::bench {
namespace {

/// Lanes whose `valid` is -1, as bits. Embree often calls filters with a single lane.
unsigned valid_lanes(const int* valid, unsigned count) {
  if (count == 1) return valid[0] ? 1u : 0u;
  unsigned lanes = 0;
#if defined(__SSE2__)
  for (unsigned i = 0; i < count; i += 4) {
    const __m128i four = _mm_loadu_si128(reinterpret_cast<const __m128i*>(valid + i));
    lanes |= static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(four))) << i;
  }
#else
  for (unsigned i = 0; i < count; ++i) lanes |= (valid[i] ? 1u : 0u) << i;
#endif
  return lanes;
}

const OpacityTable& table_of(const RTCFilterFunctionNArguments& a) {
  return *static_cast<const OpacityTable*>(a.geometryUserPtr);
}

/// Whether the ray leaves a strand. Only rays that enter a strand are stopped by it.
bool leaves_strand(const RTCFilterFunctionNArguments& a, unsigned lane) {
  if (!table_of(a).of_strands()) return false;
  return RTCHitN_Ng_x(a.hit, a.N, lane) * RTCRayN_dir_x(a.ray, a.N, lane) +
             RTCHitN_Ng_y(a.hit, a.N, lane) * RTCRayN_dir_y(a.ray, a.N, lane) +
             RTCHitN_Ng_z(a.hit, a.N, lane) * RTCRayN_dir_z(a.ray, a.N, lane) >=
         0.0f;
}

/// One lane of a filter's arguments.
struct LaneHit {
  LaneHit(const RTCFilterFunctionNArguments& a, unsigned lane)
      : ray(RTCRayN_id(a.ray, a.N, lane)),
        primitive(RTCHitN_primID(a.hit, a.N, lane)),
        instance(RTCHitN_instID(a.hit, a.N, lane, 0)),
        opacity(leaves_strand(a, lane) ? 0.0f
                                       : table_of(a).opacity(primitive, RTCHitN_u(a.hit, a.N, lane),
                                                             RTCHitN_v(a.hit, a.N, lane))) {}

  /// A hash of the triangle and its instance: always the same for one triangle, and probably
  /// different for the other triangles of a ray.
  [[nodiscard]] std::uint32_t triangle() const { return primitive + instance * 0x9e3779b1u; }

  unsigned ray, primitive, instance;
  float opacity;
};

/// Whether the ray is stopped at random. The result is the same each time this hit is reported.
bool is_stopped(const AlphaContext& context, const LaneHit& hit) {
  const std::uint32_t bits = hash_pair(hash_uint(hit.triangle()), context.keys[hit.ray]);
  return unit_float(bits) < hit.opacity;
}

void filter_stochastic(const RTCFilterFunctionNArguments& a, const AlphaContext& context) {
  for (unsigned lanes = valid_lanes(a.valid, a.N); lanes; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    if (!is_stopped(context, LaneHit(a, lane))) a.valid[lane] = 0;
  }
}

void filter_multiplicative(const RTCFilterFunctionNArguments& a, const AlphaContext& context) {
  for (unsigned lanes = valid_lanes(a.valid, a.N); lanes; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
    const LaneHit hit(a, lane);
    float& transmittance = context.transmittance[hit.ray];
    if (hit.opacity == 0.0f) {
      a.valid[lane] = 0;
      continue;
    }
    if (!context.hit || context.hit[hit.ray % kMaxLanes].add(hit.triangle()))
      transmittance *= 1.0f - hit.opacity;
    if (transmittance >= context.black) a.valid[lane] = 0;
  }
}

const AlphaContext& context_of(const RTCFilterFunctionNArguments* arguments) {
  return *reinterpret_cast<const AlphaContext*>(arguments->context);
}

}  // namespace

void filter_occluded(const RTCFilterFunctionNArguments* arguments) {
  const AlphaContext& context = context_of(arguments);
  if (context.alpha == Alpha::stochastic) {
    filter_stochastic(*arguments, context);
  } else {
    filter_multiplicative(*arguments, context);
  }
}

void filter_intersected(const RTCFilterFunctionNArguments* arguments) {
  filter_stochastic(*arguments, context_of(arguments));
}

}  // namespace dapple::bench
