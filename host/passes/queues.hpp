// Device memory of one slice of work: the queues that passes write and the next pass reads (Laine,
// Karras and Aila, "Megakernels Considered Harmful", 2013), and the film that they resolve into.
#pragma once

#include <cstddef>

#include "device/context.hpp"

namespace dapple {

/// Rays of one launch of queries at most, so that no launch trips a driver's watchdog.
inline constexpr std::size_t kQueryRays = 1u << 18;

/// Points of one launch: as kQueryRays allows, or four times as many where fewer rays do not fill
/// the device; `count` at most.
std::size_t query_points(const DeviceContext& context, std::size_t rays_per_point,
                         std::size_t count);

/// Work-items of a work-group of kernels that run one ray, pixel or hit record in each.
inline constexpr std::size_t kRayGroup = 64;

/// Queues for one slice; allocated once, used by every slice.
struct Queues {
  Buffer work;          ///< PixelWork; the caller of camera_pass() allocates it
  Buffer rays;          ///< Ray
  Buffer points;        ///< SurfacePoint, one a camera sample
  Buffer sample_hits;   ///< SampleHits, one for DAPPLE_HIT_BITS samples
  Buffer active;        ///< uint: indices of the samples that hit, ascending
  Buffer active_count;  ///< uint
  Buffer group_hits;    ///< uint: hits in the records of each work-group that compacts
  Buffer occlusions;    ///< Occlusion, one a ray
  Buffer albedo;        ///< SampleAlbedo, one a camera sample; empty unless the caller allocates it
  Buffer order;         ///< uint: the rays as scalar kernels order them; may be empty
  [[nodiscard]] std::size_t bytes() const;
};

/// Queues for `samples` camera samples, each with `rays_per_sample` rays. `work` is left empty.
Queues make_queues(DeviceContext& context, std::size_t samples, std::size_t rays_per_sample);

/// Queues for point_ao_pass(): `rays` holds only the rays of the points that are being traced, and
/// `occlusions` are floats, one a point. The caller provides `points`.
Queues make_point_queues(DeviceContext& context, std::size_t points, std::size_t rays_per_point);

/// SampleHits records that `samples` camera samples take.
std::size_t hit_records(std::size_t samples);

/// What passes resolve into.
struct FilmBuffers {
  Buffer sums;     ///< 64-bit fixed point planes as FilmLayout says
  Buffer squares;  ///< float planes, FilmLayout::squares: squared means of batches and of pairs
};

/// `count` / `size`, rounded up.
template <class T>
constexpr T ceil_div(T count, T size) {
  return (count + size - 1) / size;
}

}  // namespace dapple
