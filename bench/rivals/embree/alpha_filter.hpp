// Embree filter functions for partly transparent surfaces, for single rays and packets. In: hits
// that Embree reports. Out: hits accepted or rejected, and transmittances of rays.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

namespace dapple::bench {

/// What a surface of opacity a does to a shadow ray.
enum class Alpha : std::uint8_t {
  stochastic,      ///< stops the ray with probability a
  multiplicative,  ///< multiplies its transmittance by 1 - a
};

/// Number of rays of the widest packet.
inline constexpr unsigned kMaxLanes = 16;

/// Triangles that a ray has hit so far. Spatial splits put a triangle into several leaves, and to
/// multiply by it twice would square its transmittance. Keeps the last kCapacity triangles; rays
/// through opacities of at least 0.13 end before they hit more.
struct HitTriangles {
  static constexpr unsigned kCapacity = 64;
  unsigned count = 0;
  std::uint32_t triangles[kCapacity];

  /// False if the triangle was added before.
  bool add(std::uint32_t triangle) {
    const unsigned known = count < kCapacity ? count : kCapacity;
    for (unsigned i = 0; i < known; ++i)
      if (triangles[i] == triangle) return false;
    triangles[count++ % kCapacity] = triangle;
    return true;
  }
};

/// An Embree context, and data of each ray for the filters, indexed by the ray's id.
struct AlphaContext {
  RTCIntersectContext embree;   ///< must be first: Embree passes a pointer to it
  Alpha alpha;                  ///< of occlusion rays; intersections are stochastic
  float black;                  ///< a transmittance below this ends a ray
  const std::uint32_t* keys;    ///< random bits of each ray; only for stochastic
  float* transmittance;         ///< set to 1 by the caller; only for multiplicative
  HitTriangles* hit = nullptr;  ///< by the ray's id modulo kMaxLanes, emptied by the caller
                                ///< before each packet; nullptr: triangles are reported once
};

/// Filters of geometries whose user data is an OpacityTable. They reject hits that do not stop the
/// ray.
void filter_occluded(const RTCFilterFunctionNArguments* arguments);
void filter_intersected(const RTCFilterFunctionNArguments* arguments);

}  // namespace dapple::bench
