#include "rivals/embree/embree_picture.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "dapple/error.hpp"
#include "rivals/embree/light_sampler.hpp"
#include "rivals/embree/pixel_tiles.hpp"
#include "rivals/embree/stratified.hpp"
#include "rivals/embree/surface.hpp"

namespace dapple::bench {
namespace {

/// Offset of ray origins from surfaces, in roundings of the largest coordinate (ray_start()).
/// kernels/camera/closest_hit.cl uses 16 roundings of a slightly larger sum.
constexpr float kRoundings = 16;

/// Camera samples: all of a batch, or only those that hit something.
struct SampleBatch {
  alignas(64) std::uint32_t pixel[kBatchCapacity], sample[kBatchCapacity];
  std::uint32_t slot[kBatchCapacity];  ///< index of the pixel in its tile
};

}  // namespace

/// Buffers and steps of one thread. `sums` has kTilePixels values for each plane of a tile.
struct EmbreePictures::Worker {
  Worker(const EmbreePictures& pictures, float black)
      : renderer(pictures), tracer(pictures.scenes_, black) {}

  /// Traces the camera rays of a batch of the tile's samples, beginning with sample `first`.
  void trace_camera(const PixelTile& tile, std::size_t first, int spp, std::uint32_t seed,
                    const EmbreeMethod& method) {
    const auto per_pixel = static_cast<std::size_t>(spp);
    const auto count = static_cast<unsigned>(
        std::min<std::size_t>(kBatchCapacity, tile.count * per_pixel - first));
    std::size_t slot = first / per_pixel, sample = first % per_pixel;
    for (unsigned i = 0; i < count; ++i, ++sample) {
      if (sample == per_pixel) {
        sample = 0;
        ++slot;
      }
      samples.slot[i] = static_cast<std::uint32_t>(slot);
      samples.pixel[i] = tile.pixels[slot];
      samples.sample[i] = static_cast<std::uint32_t>(sample);
    }
    renderer.camera_.fill(samples.pixel, samples.sample, count, seed, x, y, rays);
    tracer.intersection(method, rays, hits);
  }

  /// Collects the points that the last camera rays hit. Samples without a hit add `sky` to the
  /// sums.
  void gather(double sky) {
    hit_count = 0;
    for (unsigned i = 0; i < rays.count; ++i) {
      if (hits.geometry[i] == RTC_INVALID_GEOMETRY_ID) {
        sums[samples.slot[i]] += sky;
        continue;
      }
      const Surface surface = surface_of(renderer.scenes_.medium.geometry(), rays, hits, i);
      const V3f start = ray_start(surface, kRoundings);
      for (int axis = 0; axis < 3; ++axis) {
        origin[axis][hit_count] = start[axis];
        normal[axis][hit_count] = surface.normal[axis];
      }
      hit_samples.pixel[hit_count] = samples.pixel[i];
      hit_samples.sample[hit_count] = samples.sample[i];
      hit_samples.slot[hit_count++] = samples.slot[i];
    }
  }

  /// Traces one AO ray from every hit point: number `ray` of the `of` rays of each.
  void add_ao(std::uint32_t seed, const EmbreeMethod& method, std::uint32_t ray, std::uint32_t of) {
    for (unsigned i = 0; i < hit_count; ++i) index[i] = hit_samples.sample[i] * of + ray;
    sample_squares(hit_samples.pixel, index, hit_count, kAoPair, seed, x, y);
    const float* const about[3] = {normal[0], normal[1], normal[2]};
    float* const into[3] = {rays.direction[0], rays.direction[1], rays.direction[2]};
    cosine_directions(x, y, about, hit_count, into);
    ray_keys(hit_samples.pixel, index, hit_count, kAoPair, seed, rays.key);
    for (int axis = 0; axis < 3; ++axis) std::copy_n(origin[axis], hit_count, rays.origin[axis]);
    std::fill_n(rays.t_max, hit_count, std::numeric_limits<float>::infinity());
    rays.count = hit_count;
    tracer.occlusion(method, rays, found);
    for (unsigned i = 0; i < hit_count; ++i)
      sums[hit_samples.slot[i]] += static_cast<double>(found.transmittance[i]) / of;
  }

  /// Traces one ray to the light from every hit point. Rays that cannot add light are left out.
  void add_light(unsigned light, std::uint32_t seed, const EmbreeMethod& method) {
    sample_squares(hit_samples.pixel, hit_samples.sample, hit_count, kLightPair + light, seed, x,
                   y);
    rays.count = 0;
    for (unsigned i = 0; i < hit_count; ++i) {
      const V3f from(origin[0][i], origin[1][i], origin[2][i]);
      const LightSample sample = renderer.lights_[light](from, x[i], y[i]);
      const float cosine = normal[0][i] * sample.direction.x + normal[1][i] * sample.direction.y +
                           normal[2][i] * sample.direction.z;
      if (cosine * sample.weight <= 0) continue;
      const unsigned ray = rays.count++;
      for (int axis = 0; axis < 3; ++axis) {
        rays.origin[axis][ray] = from[axis];
        rays.direction[axis][ray] = sample.direction[axis];
      }
      rays.t_max[ray] = sample.distance;
      rays.key[ray] =
          ray_key(hit_samples.pixel[i], hit_samples.sample[i], kLightPair + light, seed);
      weight[ray] = cosine * sample.weight;
      lit_slot[ray] = light * kTilePixels + hit_samples.slot[i];
    }
    tracer.occlusion(method, rays, found);
    for (unsigned i = 0; i < rays.count; ++i)
      sums[lit_slot[i]] += weight[i] * found.transmittance[i];
  }

  const EmbreePictures& renderer;
  EmbreeTracer tracer;
  RayBatch rays;
  HitBatch hits;
  TransmittanceBatch found;
  SampleBatch samples, hit_samples;
  alignas(64) std::uint32_t index[kBatchCapacity];
  unsigned hit_count = 0;
  alignas(64) float origin[3][kBatchCapacity], normal[3][kBatchCapacity];
  alignas(64) float x[kBatchCapacity], y[kBatchCapacity];
  float weight[kBatchCapacity];
  std::uint32_t lit_slot[kBatchCapacity];
  std::vector<double> sums;
};

EmbreePictures::EmbreePictures(const EmbreeScenes& scenes, const View& view,
                               const std::vector<Light>& lights)
    : scenes_(scenes), camera_(view) {
  for (const Light& light : lights) {
    if (!can_sample(light))
      throw Error(ErrorKind::usage,
                  fmt::format("rivals: {} is a mesh or dome light, which the Embree side "
                              "cannot sample; measure --pass ao",
                              light.name));
    lights_.emplace_back(light);
  }
}

template <class Work>
void EmbreePictures::for_each_tile(float black, const Work& work) const {
  const std::vector<PixelTile> tiles = pixel_tiles(camera_.width(), camera_.height());
  tbb::enumerable_thread_specific<std::unique_ptr<Worker>> workers(
      [&] { return std::make_unique<Worker>(*this, black); });
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const FlushDenormals flush;
    work(*workers.local(), tiles[t]);
  });
}

std::vector<double> EmbreePictures::render(Pass pass, int spp, std::uint32_t seed,
                                           const PictureMethod& method, float black) const {
  const auto pixels =
      static_cast<std::size_t>(camera_.width()) * static_cast<std::size_t>(camera_.height());
  const std::size_t planes = pass == Pass::ao ? 1 : lights_.size();
  std::vector<double> picture(planes * pixels);
  for_each_tile(black, [&](Worker& worker, const PixelTile& tile) {
    worker.sums.assign(planes * kTilePixels, 0.0);
    const std::size_t samples = tile.count * static_cast<std::size_t>(spp);
    for (std::size_t first = 0; first < samples; first += kBatchCapacity) {
      worker.trace_camera(tile, first, spp, seed, method.camera);
      worker.gather(pass == Pass::ao ? 1.0 : 0.0);
      if (pass == Pass::ao) {
        for (std::uint32_t ray = 0; ray < method.ao_rays; ++ray)
          worker.add_ao(seed, method.occlusion, ray, method.ao_rays);
      } else {
        for (unsigned l = 0; l < planes; ++l) worker.add_light(l, seed, method.occlusion);
      }
    }
    for (std::size_t plane = 0; plane < planes; ++plane)
      for (unsigned i = 0; i < tile.count; ++i)
        picture[plane * pixels + tile.pixels[i]] = worker.sums[plane * kTilePixels + i] / spp;
  });
  return picture;
}

void EmbreePictures::trace_camera_rays(int spp, std::uint32_t seed,
                                       const EmbreeMethod& method) const {
  for_each_tile(kContestBlack, [&](Worker& worker, const PixelTile& tile) {
    const std::size_t samples = tile.count * static_cast<std::size_t>(spp);
    for (std::size_t first = 0; first < samples; first += kBatchCapacity)
      worker.trace_camera(tile, first, spp, seed, method);
  });
}

}  // namespace dapple::bench
