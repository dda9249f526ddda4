// Rays side by side, as Embree's packets and vector loops take them: what one thread works on.
#pragma once

#include <cstdint>

namespace dapple::bench {

/// Small enough for a core's second-level cache, large enough that half-filled packets at its
/// end don't count.
inline constexpr unsigned kBatchCapacity = 1024;

struct RayBatch {
  unsigned count = 0;
  alignas(64) float origin[3][kBatchCapacity];
  alignas(64) float direction[3][kBatchCapacity];  ///< unit vectors
  alignas(64) float t_max[kBatchCapacity];         ///< metres
  alignas(64) std::uint32_t key[kBatchCapacity];   ///< random bits for stochastic opacity

  [[nodiscard]] bool is_full() const { return count == kBatchCapacity; }
};

/// What a batch of occlusion rays found.
struct TransmittanceBatch {
  alignas(64) float transmittance[kBatchCapacity];  ///< [0,1]
};

/// What a batch of camera rays met. Where `geometry` is RTC_INVALID_GEOMETRY_ID: nothing.
struct HitBatch {
  alignas(64) float u[kBatchCapacity], v[kBatchCapacity];  ///< Embree's barycentrics
  alignas(64) float t[kBatchCapacity];                     ///< metres
  alignas(64) std::uint32_t primitive[kBatchCapacity], geometry[kBatchCapacity];
  alignas(64) std::uint32_t instance[kBatchCapacity];  ///< RTC_INVALID_GEOMETRY_ID in flat scenes
};

}  // namespace dapple::bench
