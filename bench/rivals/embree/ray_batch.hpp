// Batches of rays and of their results, as structures of arrays for Embree's packets and for
// vectorized loops. A thread works on one batch at a time.
#pragma once

#include <cstdint>

namespace dapple::bench {

/// Small enough for a core's second-level cache, and so large that a partly filled packet at its
/// end hardly matters.
inline constexpr unsigned kBatchCapacity = 1024;

/// Rays past `count` are finite, too: where Embree traces a packet of 16 as two of 8 (AVX2), it
/// asserts that of lanes which are not valid.
struct RayBatch {
  unsigned count = 0;
  alignas(64) float origin[3][kBatchCapacity] = {};
  alignas(64) float direction[3][kBatchCapacity] = {};  ///< unit vectors
  alignas(64) float t_max[kBatchCapacity] = {};         ///< metres
  alignas(64) std::uint32_t key[kBatchCapacity] = {};   ///< random bits for stochastic opacity

  [[nodiscard]] bool is_full() const { return count == kBatchCapacity; }
};

/// Results of a batch of occlusion rays.
struct TransmittanceBatch {
  alignas(64) float transmittance[kBatchCapacity];  ///< [0,1]
};

/// Hits of a batch of camera rays. `geometry` is RTC_INVALID_GEOMETRY_ID for rays without a hit.
struct HitBatch {
  alignas(64) float u[kBatchCapacity], v[kBatchCapacity];  ///< Embree's barycentrics
  alignas(64) float t[kBatchCapacity];                     ///< metres
  alignas(64) std::uint32_t primitive[kBatchCapacity], geometry[kBatchCapacity];
  alignas(64) std::uint32_t instance[kBatchCapacity];  ///< RTC_INVALID_GEOMETRY_ID in flat scenes
};

}  // namespace dapple::bench
