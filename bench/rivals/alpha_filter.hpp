// The filters that make Embree see through leaves, for single rays and packets alike.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

namespace dapple::bench {

/// How a shadow ray passes a surface of opacity a.
enum class Alpha : std::uint8_t {
  stochastic,      ///< it is stopped with probability a
  multiplicative,  ///< its transmittance is multiplied by 1 - a
};

/// Rays of the widest packet.
inline constexpr unsigned kMaxLanes = 16;

/// Triangles that a ray has met already. Spatial splits put a triangle into several leaves, and
/// multiplying by it twice squares its transmittance. Of more than kCapacity the oldest are
/// forgotten; rays at opacities down to 0.13 end before that.
struct MetTriangles {
  static constexpr unsigned kCapacity = 64;
  unsigned count = 0;
  std::uint32_t triangles[kCapacity];

  /// False where the triangle had been added before.
  bool add(std::uint32_t triangle) {
    const unsigned known = count < kCapacity ? count : kCapacity;
    for (unsigned i = 0; i < known; ++i)
      if (triangles[i] == triangle) return false;
    triangles[count++ % kCapacity] = triangle;
    return true;
  }
};

/// An Embree context with what the filters need of each ray, by the ray's id.
struct AlphaContext {
  RTCIntersectContext embree;   ///< first: Embree hands back a pointer to it
  Alpha alpha;                  ///< of occlusion rays; intersections are stochastic
  float black;                  ///< a transmittance below this ends a ray
  const std::uint32_t* keys;    ///< random bits a ray; stochastic
  float* transmittance;         ///< set to 1 by the caller; multiplicative
  MetTriangles* met = nullptr;  ///< by the ray's id modulo kMaxLanes, emptied by the caller
                                ///< before each packet; nullptr: no triangle comes twice
};

/// For geometries whose user data is an OpacityTable. Reject the hits that let the ray through.
void filter_occluded(const RTCFilterFunctionNArguments* arguments);
void filter_intersected(const RTCFilterFunctionNArguments* arguments);

}  // namespace dapple::bench
