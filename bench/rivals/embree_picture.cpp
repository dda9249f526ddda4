#include "rivals/embree_picture.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "dapple/error.hpp"
#include "rivals/light_sampler.hpp"
#include "rivals/pixel_tiles.hpp"
#include "rivals/stratified.hpp"
#include "rivals/surface.hpp"

namespace dapple::bench {
namespace {

/// Roundings of the largest coordinate by which rays start off surfaces;
/// kernels/camera/closest_hit.cl takes 16 of a sum that is little larger.
constexpr float kRoundings = 16;

/// Camera samples, or those of them that met something.
struct SampleBatch {
  alignas(64) std::uint32_t pixel[kBatchCapacity], sample[kBatchCapacity];
  std::uint32_t slot[kBatchCapacity];  ///< the pixel's place in its tile
};

}  // namespace

/// What one thread works with. A tile's sums are plane after plane of kTilePixels.
struct EmbreePictures::Worker {
  Worker(const EmbreePictures& pictures, float black)
      : renderer(pictures), tracer(pictures.scenes_, black) {}

  /// Samples first... of all the tile's, and what their camera rays meet.
  void look(const PixelTile& tile, std::size_t first, int spp, std::uint32_t seed,
            const EmbreeMethod& method) {
    const auto samples = static_cast<std::size_t>(spp);
    const auto count =
        static_cast<unsigned>(std::min<std::size_t>(kBatchCapacity, tile.count * samples - first));
    std::size_t slot = first / samples, sample = first % samples;
    for (unsigned i = 0; i < count; ++i, ++sample) {
      if (sample == samples) {
        sample = 0;
        ++slot;
      }
      asked.slot[i] = static_cast<std::uint32_t>(slot);
      asked.pixel[i] = tile.pixels[slot];
      asked.sample[i] = static_cast<std::uint32_t>(sample);
    }
    renderer.camera_.fill(asked.pixel, asked.sample, count, seed, x, y, rays);
    tracer.intersection(method, rays, hits);
  }

  /// Points that the last camera rays met, side by side. Samples that met nothing add `sky`.
  void gather(double sky) {
    met_count = 0;
    for (unsigned i = 0; i < rays.count; ++i) {
      if (hits.geometry[i] == RTC_INVALID_GEOMETRY_ID) {
        sums[asked.slot[i]] += sky;
        continue;
      }
      const Surface surface = surface_of(renderer.scenes_.medium.geometry(), rays, hits, i);
      const V3f start = ray_start(surface, kRoundings);
      for (int axis = 0; axis < 3; ++axis) {
        origin[axis][met_count] = start[axis];
        normal[axis][met_count] = surface.normal[axis];
      }
      met.pixel[met_count] = asked.pixel[i];
      met.sample[met_count] = asked.sample[i];
      met.slot[met_count++] = asked.slot[i];
    }
  }

  /// The `ray`th of `of` from every point.
  void add_ao(std::uint32_t seed, const EmbreeMethod& method, std::uint32_t ray, std::uint32_t of) {
    for (unsigned i = 0; i < met_count; ++i) index[i] = met.sample[i] * of + ray;
    sample_squares(met.pixel, index, met_count, kAoPair, seed, x, y);
    const float* const about[3] = {normal[0], normal[1], normal[2]};
    float* const into[3] = {rays.direction[0], rays.direction[1], rays.direction[2]};
    cosine_directions(x, y, about, met_count, into);
    ray_keys(met.pixel, index, met_count, kAoPair, seed, rays.key);
    for (int axis = 0; axis < 3; ++axis) std::copy_n(origin[axis], met_count, rays.origin[axis]);
    std::fill_n(rays.t_max, met_count, std::numeric_limits<float>::infinity());
    rays.count = met_count;
    tracer.occlusion(method, rays, found);
    for (unsigned i = 0; i < met_count; ++i)
      sums[met.slot[i]] += static_cast<double>(found.transmittance[i]) / of;
  }

  /// Rays that can bring nothing are not traced.
  void add_light(unsigned light, std::uint32_t seed, const EmbreeMethod& method) {
    sample_squares(met.pixel, met.sample, met_count, kLightPair + light, seed, x, y);
    rays.count = 0;
    for (unsigned i = 0; i < met_count; ++i) {
      const V3f from(origin[0][i], origin[1][i], origin[2][i]);
      const LightSample sample = sample_light(renderer.lights_[light], from, x[i], y[i]);
      const float cosine = normal[0][i] * sample.direction.x + normal[1][i] * sample.direction.y +
                           normal[2][i] * sample.direction.z;
      if (cosine * sample.weight <= 0) continue;
      const unsigned ray = rays.count++;
      for (int axis = 0; axis < 3; ++axis) {
        rays.origin[axis][ray] = from[axis];
        rays.direction[axis][ray] = sample.direction[axis];
      }
      rays.t_max[ray] = sample.distance;
      rays.key[ray] = ray_key(met.pixel[i], met.sample[i], kLightPair + light, seed);
      weight[ray] = cosine * sample.weight;
      lit_slot[ray] = light * kTilePixels + met.slot[i];
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
  SampleBatch asked, met;
  alignas(64) std::uint32_t index[kBatchCapacity];
  unsigned met_count = 0;
  alignas(64) float origin[3][kBatchCapacity], normal[3][kBatchCapacity];
  alignas(64) float x[kBatchCapacity], y[kBatchCapacity];
  float weight[kBatchCapacity];
  std::uint32_t lit_slot[kBatchCapacity];
  std::vector<double> sums;
};

EmbreePictures::EmbreePictures(const EmbreeScenes& scenes, const View& view,
                               std::vector<Light> lights)
    : scenes_(scenes), camera_(view), lights_(std::move(lights)) {
  for (const Light& light : lights_) {
    if (!can_sample(light))
      throw Error(ErrorKind::usage,
                  fmt::format("rivals: {} is a mesh or dome light, which the Embree side "
                              "cannot sample; measure --pass ao",
                              light.name));
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
      worker.look(tile, first, spp, seed, method.camera);
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
      worker.look(tile, first, spp, seed, method);
  });
}

}  // namespace dapple::bench
