#include "rivals/embree/ao_points.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "rivals/embree/pixel_tiles.hpp"
#include "rivals/embree/stratified.hpp"

namespace dapple::bench {
namespace {

/// Buffers of one thread.
struct Worker {
  Worker(const EmbreeScenes& scenes, float black) : tracer(scenes, black) {}
  EmbreeTracer tracer;
  RayBatch rays;
  TransmittanceBatch found;
};

using Workers = tbb::enumerable_thread_specific<std::unique_ptr<Worker>>;

/// Writes the AO of the points [first, end) to `ao`.
void occlude(Worker& worker, const EmbreeMethod& method, std::span<const Surface> points,
             std::size_t rays, std::size_t first, std::size_t end, std::uint32_t seed, double* ao) {
  const FlushDenormals flush;
  for (std::size_t item = first * rays; item < end * rays; item += worker.rays.count) {
    fill_ao_rays(points.first(end), rays, item, seed, worker.rays);
    worker.tracer.occlusion(method, worker.rays, worker.found);
    std::size_t point = item / rays, next = (point + 1) * rays;
    for (unsigned i = 0; i < worker.rays.count; ++i) {
      if (item + i == next) {
        ++point;
        next += rays;
      }
      ao[point] += worker.found.transmittance[i];
    }
  }
  for (std::size_t point = first; point < end; ++point) ao[point] /= static_cast<double>(rays);
}

}  // namespace

void fill_ao_rays(std::span<const Surface> points, std::size_t rays, std::size_t first,
                  std::uint32_t seed, RayBatch& batch) {
  alignas(64) std::uint32_t pixel[kBatchCapacity], index[kBatchCapacity];
  alignas(64) float x[kBatchCapacity], y[kBatchCapacity], normal[3][kBatchCapacity];
  const auto count =
      static_cast<unsigned>(std::min<std::size_t>(kBatchCapacity, points.size() * rays - first));
  std::size_t point = first / rays, ray = first % rays;
  V3f start = ray_start(points[point], kPointRoundings);
  for (unsigned i = 0; i < count; ++i) {
    if (ray == rays) {
      ray = 0;
      start = ray_start(points[++point], kPointRoundings);
    }
    pixel[i] = static_cast<std::uint32_t>(point);
    index[i] = static_cast<std::uint32_t>(ray++);
    for (int axis = 0; axis < 3; ++axis) {
      batch.origin[axis][i] = start[axis];
      normal[axis][i] = points[point].normal[axis];
    }
    batch.t_max[i] = std::numeric_limits<float>::infinity();
  }
  batch.count = count;
  sample_squares(pixel, index, count, kAoPair, seed, x, y);
  const float* const about[3] = {normal[0], normal[1], normal[2]};
  float* const into[3] = {batch.direction[0], batch.direction[1], batch.direction[2]};
  vogel_points(pixel, index, count, rays, seed, x, y);
  lift_to_directions(x, y, about, count, into);
  ray_keys(pixel, index, count, kAoPair, seed, batch.key);
}

std::vector<double> embree_occlusion(const EmbreeScenes& scenes, const EmbreeMethod& method,
                                     std::span<const Surface> points, std::size_t rays,
                                     std::uint32_t seed, float black) {
  std::vector<double> ao(points.size());
  Workers workers([&] { return std::make_unique<Worker>(scenes, black); });
  const std::size_t grain = std::max<std::size_t>(1, kBatchCapacity / rays);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, points.size(), grain),
      [&](const tbb::blocked_range<std::size_t>& range) {
        occlude(*workers.local(), method, points, rays, range.begin(), range.end(), seed,
                ao.data());
      },
      tbb::simple_partitioner());
  return ao;
}

std::vector<Surface> visible_points(const EmbreeScenes& scenes, const CameraRays& camera,
                                    std::size_t most) {
  const auto rays = std::make_unique<RayBatch>();
  const auto hits = std::make_unique<HitBatch>();
  EmbreeTracer tracer(scenes, kContestBlack);
  std::vector<Surface> seen;
  for (const PixelTile& tile : pixel_tiles(camera.width(), camera.height())) {
    const std::uint32_t samples[kTilePixels]{};
    float x[kTilePixels], y[kTilePixels];
    camera.fill(tile.pixels, samples, tile.count, 0, x, y, *rays);
    tracer.intersection({}, *rays, *hits);
    for (unsigned i = 0; i < rays->count; ++i) {
      if (hits->geometry[i] != RTC_INVALID_GEOMETRY_ID)
        seen.push_back(surface_of(scenes.medium.geometry(), *rays, *hits, i));
    }
  }
  if (seen.size() <= most) return seen;
  std::vector<Surface> thinned;
  for (std::size_t i = 0; i < most; ++i) thinned.push_back(seen[i * seen.size() / most]);
  return thinned;
}

}  // namespace dapple::bench
