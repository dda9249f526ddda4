#include "rivals/embree/embree_trace.hpp"

#include <algorithm>
#include <cstring>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace dapple::bench {
namespace {

template <unsigned kWidth>
struct PacketTypes;

template <>
struct PacketTypes<8> {
  using Ray = RTCRay8;
  using RayHit = RTCRayHit8;
  static constexpr auto kOccluded = rtcOccluded8;
  static constexpr auto kIntersect = rtcIntersect8;
};

template <>
struct PacketTypes<16> {
  using Ray = RTCRay16;
  using RayHit = RTCRayHit16;
  static constexpr auto kOccluded = rtcOccluded16;
  static constexpr auto kIntersect = rtcIntersect16;
};

/// Sets the members that are equal for all packets of a batch.
template <unsigned kWidth>
void prepare(typename PacketTypes<kWidth>::Ray& packet) {
  for (unsigned i = 0; i < kWidth; ++i) {
    packet.tnear[i] = packet.time[i] = 0.0f;
    packet.mask[i] = ~0u;
    packet.flags[i] = 0;
  }
}

/// Copies the rays [first, first + kWidth) of the batch. Lanes past its end are invalid in `valid`.
template <unsigned kWidth>
void load(const RayBatch& rays, unsigned first, typename PacketTypes<kWidth>::Ray& packet,
          int* valid) {
  constexpr std::size_t kBytes = kWidth * sizeof(float);
  std::memcpy(packet.org_x, rays.origin[0] + first, kBytes);
  std::memcpy(packet.org_y, rays.origin[1] + first, kBytes);
  std::memcpy(packet.org_z, rays.origin[2] + first, kBytes);
  std::memcpy(packet.dir_x, rays.direction[0] + first, kBytes);
  std::memcpy(packet.dir_y, rays.direction[1] + first, kBytes);
  std::memcpy(packet.dir_z, rays.direction[2] + first, kBytes);
  std::memcpy(packet.tfar, rays.t_max + first, kBytes);
  for (unsigned i = 0; i < kWidth; ++i) {
    packet.id[i] = first + i;
    valid[i] = first + i < rays.count ? -1 : 0;
  }
}

void clear_hit_triangles(AlphaContext& context) {
  if (!context.hit) return;
  for (unsigned i = 0; i < kMaxLanes; ++i) context.hit[i].count = 0;
}

/// Sets the transmittance of stopped rays to 0: Embree makes their tfar negative.
void darken_stopped(const float* tfar, unsigned count, float* transmittance) {
  for (unsigned i = 0; i < count; ++i) transmittance[i] = tfar[i] < 0.0f ? 0.0f : transmittance[i];
}

template <unsigned kWidth>
void occlusion_packets(RTCScene scene, AlphaContext& context, const RayBatch& rays,
                       float* transmittance) {
  typename PacketTypes<kWidth>::Ray packet;
  alignas(64) int valid[kWidth];
  prepare<kWidth>(packet);
  for (unsigned first = 0; first < rays.count; first += kWidth) {
    load<kWidth>(rays, first, packet, valid);
    clear_hit_triangles(context);
    PacketTypes<kWidth>::kOccluded(valid, scene, &context.embree, &packet);
    darken_stopped(packet.tfar, std::min(kWidth, rays.count - first), transmittance + first);
  }
}

RTCRay single_ray(const RayBatch& rays, unsigned i) {
  RTCRay ray{};
  ray.org_x = rays.origin[0][i];
  ray.org_y = rays.origin[1][i];
  ray.org_z = rays.origin[2][i];
  ray.dir_x = rays.direction[0][i];
  ray.dir_y = rays.direction[1][i];
  ray.dir_z = rays.direction[2][i];
  ray.tfar = rays.t_max[i];
  ray.mask = ~0u;
  ray.id = i;
  return ray;
}

void occlusion_singles(RTCScene scene, AlphaContext& context, const RayBatch& rays,
                       float* transmittance) {
  for (unsigned i = 0; i < rays.count; ++i) {
    RTCRay ray = single_ray(rays, i);
    clear_hit_triangles(context);
    rtcOccluded1(scene, &context.embree, &ray);
    darken_stopped(&ray.tfar, 1, transmittance + i);
  }
}

template <unsigned kWidth>
void intersection_packets(RTCScene scene, AlphaContext& context, const RayBatch& rays,
                          HitBatch& found) {
  typename PacketTypes<kWidth>::RayHit packet;
  alignas(64) int valid[kWidth];
  prepare<kWidth>(packet.ray);
  constexpr std::size_t kBytes = kWidth * sizeof(float);
  for (unsigned first = 0; first < rays.count; first += kWidth) {
    load<kWidth>(rays, first, packet.ray, valid);
    std::fill_n(packet.hit.geomID, kWidth, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kWidth, RTC_INVALID_GEOMETRY_ID);
    PacketTypes<kWidth>::kIntersect(valid, scene, &context.embree, &packet);
    std::memcpy(found.t + first, packet.ray.tfar, kBytes);
    std::memcpy(found.u + first, packet.hit.u, kBytes);
    std::memcpy(found.v + first, packet.hit.v, kBytes);
    std::memcpy(found.primitive + first, packet.hit.primID, kBytes);
    std::memcpy(found.geometry + first, packet.hit.geomID, kBytes);
    std::memcpy(found.instance + first, packet.hit.instID[0], kBytes);
  }
}

void intersection_singles(RTCScene scene, AlphaContext& context, const RayBatch& rays,
                          HitBatch& found) {
  for (unsigned i = 0; i < rays.count; ++i) {
    RTCRayHit query{single_ray(rays, i), {}};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context.embree, &query);
    found.t[i] = query.ray.tfar;
    found.u[i] = query.hit.u;
    found.v[i] = query.hit.v;
    found.primitive[i] = query.hit.primID;
    found.geometry[i] = query.hit.geomID;
    found.instance[i] = query.hit.instID[0];
  }
}

}  // namespace

std::string EmbreeMethod::name() const {
  std::string text = alpha == Alpha::stochastic ? "stochastic " : "multiplicative ";
  return text + std::to_string(width) + (coherent ? " coherent" : "") +
         (high ? " high" : " medium");
}

std::vector<EmbreeMethod> occlusion_methods(bool coherent) {
  std::vector<EmbreeMethod> methods;
  for (const Alpha alpha : {Alpha::stochastic, Alpha::multiplicative}) {
    for (const bool high : {false, true}) {
      for (const int width : {1, 8, 16}) {
        methods.push_back({alpha, width, high, false});
        if (coherent && width > 1) methods.push_back({alpha, width, high, true});
      }
    }
  }
  return methods;
}

std::vector<EmbreeMethod> camera_methods(bool coherent) {
  std::vector<EmbreeMethod> methods = occlusion_methods(coherent);
  std::erase_if(methods, [](const EmbreeMethod& m) { return m.alpha != Alpha::stochastic; });
  return methods;
}

// The filter writes to `transmittance`, which clang-tidy does not see.
AlphaContext EmbreeTracer::context(
    const EmbreeMethod& method, const RayBatch& rays,
    float* transmittance) {  // NOLINT(readability-non-const-parameter)
  AlphaContext context{{}, method.alpha, black_, rays.key, transmittance, nullptr};
  rtcInitIntersectContext(&context.embree);
  if (method.coherent) context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

void EmbreeTracer::occlusion(const EmbreeMethod& method, const RayBatch& rays,
                             TransmittanceBatch& found) {
  AlphaContext context = this->context(method, rays, found.transmittance);
  std::fill_n(found.transmittance, rays.count, 1.0f);
  const EmbreeScene& scene = method.scene(scenes_);
  // With spatial splits, and in coherent packets, a filter may be called twice for a triangle.
  const bool may_repeat = scene.has_spatial_splits() || method.coherent;
  if (method.alpha == Alpha::multiplicative && may_repeat) context.hit = hit_;
  if (method.width == 1) {
    occlusion_singles(scene.top(), context, rays, found.transmittance);
  } else if (method.width == 8) {
    occlusion_packets<8>(scene.top(), context, rays, found.transmittance);
  } else {
    occlusion_packets<16>(scene.top(), context, rays, found.transmittance);
  }
}

void EmbreeTracer::intersection(const EmbreeMethod& method, const RayBatch& rays, HitBatch& found) {
  AlphaContext context = this->context(method, rays, nullptr);
  const RTCScene scene = method.scene(scenes_).top();
  if (method.width == 1) {
    intersection_singles(scene, context, rays, found);
  } else if (method.width == 8) {
    intersection_packets<8>(scene, context, rays, found);
  } else {
    intersection_packets<16>(scene, context, rays, found);
  }
}

#if defined(__SSE2__)
FlushDenormals::FlushDenormals() : before_(_mm_getcsr()) {
  constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero);
}
FlushDenormals::~FlushDenormals() { _mm_setcsr(before_); }
#else
FlushDenormals::FlushDenormals() = default;
FlushDenormals::~FlushDenormals() = default;
#endif

}  // namespace dapple::bench
