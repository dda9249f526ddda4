#include "wavefront/picture.hpp"

#include <algorithm>
#include <limits>

#include "wavefront/passes.hpp"

namespace dapple {
namespace {

/// Rays in flight: on a CPU few enough for the queues to stay in its caches, on a GPU
/// enough to fill it.
constexpr std::size_t kCpuSlice = 1u << 15;
constexpr std::size_t kGpuSlice = 1u << 19;

class PictureTracer {
 public:
  PictureTracer(const Device& device, const DeviceScene& scene, const View& view,
                const RenderOptions& options, const FilmLayout& layout, std::size_t light_count)
      : context_(device.context()),
        scene_(*scene.buffers),
        options_(options),
        layout_(layout),
        light_count_(options.light ? light_count : 0),
        camera_(camera_params(view, options)) {
    const std::size_t rays = static_cast<std::size_t>(
        std::max({1, options.ao ? options.ao_rays : 1, light_count_ ? options.light_rays : 1}));
    const std::size_t samples =
        std::max<std::size_t>(1, (device.info().kind == "GPU" ? kGpuSlice : kCpuSlice) / rays);
    const auto spp = static_cast<std::size_t>(options.spp);
    slice_samples_ = static_cast<uint>(std::min(spp, samples));
    slice_pixels_ = static_cast<uint>(std::max<std::size_t>(1, samples / slice_samples_));
    slice_pixels_ = std::min(slice_pixels_, layout.pixels);
    queues_ = make_queues(context_, std::size_t{slice_pixels_} * slice_samples_, rays);
    sums_ = context_.allocate(layout.bytes());
    context_.fill_zero(sums_);
    resolve_ = resolve_params(view);
  }

  TracedPicture trace(const Progress& progress) {
    const auto spp = static_cast<uint>(options_.spp);
    const double total = static_cast<double>(layout_.pixels) * spp;
    double done = 0;
    for (uint pixel = 0; pixel < layout_.pixels; pixel += slice_pixels_) {
      for (uint sample = 0; sample < spp; sample += slice_samples_) {
        const SliceParams slice{pixel, std::min(slice_pixels_, layout_.pixels - pixel), sample,
                                std::min(slice_samples_, spp - sample)};
        trace_slice(slice);
        done += static_cast<double>(slice.pixel_count) * slice.sample_count;
        if (progress) progress(done / total);
      }
    }
    TracedPicture picture;
    picture.sums.resize(layout_.bytes() / sizeof(std::int64_t));
    context_.read(sums_, picture.sums.data(), layout_.bytes());
    context_.finish();
    picture.queue_bytes = queues_.bytes();
    return picture;
  }

 private:
  ResolveParams resolve_params(const View& view) const {
    ResolveParams params{};
    params.film_pixels = layout_.pixels;
    params.position_scale = layout_.position_scale;
    params.depth_scale = layout_.depth_scale;
    const M44f& m = view.camera.to_world;
    for (int axis = 0; axis < 3; ++axis) {
      params.axis[axis] = -m[2][axis];
      params.eye[axis] = m[3][axis];
    }
    return params;
  }

  void trace_slice(const SliceParams& slice) {
    const std::size_t samples = std::size_t{slice.pixel_count} * slice.sample_count;
    camera_.slice = slice;
    resolve_.slice = slice;
    camera_pass(context_, queues_, camera_);
    closest_hit_pass(context_, scene_, queues_, samples);
    resolve_.plane = 0;
    resolve_.scale = layout_.unit_scale;
    resolve_surface_pass(context_, queues_, sums_, resolve_);
    const std::uint32_t hits = compact_pass(context_, queues_, samples);
    if (hits == 0) return;
    if (options_.ao) trace_ao(hits);
    for (uint light = 0; light < light_count_; ++light) trace_light(light, hits);
  }

  void trace_ao(std::uint32_t hits) {
    AoParams ao{};
    ao.point_count = hits;
    ao.rays = static_cast<uint>(options_.ao_rays);
    ao.inverse_count =
        1.0f / (static_cast<float>(options_.spp) * static_cast<float>(options_.ao_rays));
    ao.t_max =
        options_.ao_distance > 0 ? options_.ao_distance : std::numeric_limits<float>::infinity();
    ao.seed = options_.seed;
    ao_ray_pass(context_, queues_, ao);
    OcclusionParams params = occlusion_params(hits, ao.rays);
    if (options_.ao_distance > 0 && options_.ao_falloff > 0) {
      params.inverse_distance = 1.0f / options_.ao_distance;
      params.falloff = options_.ao_falloff;
    }
    occlusion_pass(context_, queues_, scene_, "ao occlusion", options_.estimator, params);
    resolve_.plane = layout_.ao;
    resolve_.rays = ao.rays;
    resolve_.scale = layout_.unit_scale;
    resolve_ao_pass(context_, queues_, sums_, resolve_);
  }

  void trace_light(uint light, std::uint32_t hits) {
    LightParams params{};
    params.point_count = hits;
    params.rays = static_cast<uint>(options_.light_rays);
    params.inverse_count =
        1.0f / (static_cast<float>(options_.spp) * static_cast<float>(options_.light_rays));
    params.light = light;
    params.seed = options_.seed;
    light_ray_pass(context_, scene_, queues_, params);
    occlusion_pass(context_, queues_, scene_, "light occlusion", options_.estimator,
                   occlusion_params(hits, params.rays));
    resolve_.plane = layout_.lights[light];
    resolve_.rays = params.rays;
    resolve_.scale = layout_.light_scale;
    resolve_light_pass(context_, queues_, sums_, resolve_);
  }

  [[nodiscard]] OcclusionParams occlusion_params(uint points, uint rays_per_point) const {
    OcclusionParams params{};
    params.scene = scene_.params;
    params.ray_count = points * rays_per_point;
    params.rays_per_point = rays_per_point;
    params.footprint = options_.footprint;
    return params;
  }

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  const FilmLayout& layout_;
  std::size_t light_count_;
  CameraParams camera_;
  ResolveParams resolve_{};
  uint slice_pixels_ = 1, slice_samples_ = 1;
  Queues queues_;
  Buffer sums_;
};

}  // namespace

TracedPicture trace_picture(const Device& device, const DeviceScene& scene, const View& view,
                            const RenderOptions& options, const FilmLayout& layout,
                            std::size_t light_count, const Progress& progress) {
  return PictureTracer(device, scene, view, options, layout, light_count).trace(progress);
}

}  // namespace dapple
