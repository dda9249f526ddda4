#include "render/picture_rays.hpp"

#include "passes/light_pass.hpp"
#include "passes/occlusion_pass.hpp"

namespace dapple {

OcclusionParams PictureRays::make_ao(const Queues& queues, std::uint32_t hits) const {
  AoParams ao{};
  ao.point_count = hits;
  ao.rays = static_cast<uint>(ao_rays_);
  ao.inverse_count = 1.0f / (static_cast<float>(footprint_samples(options_)) *
                             static_cast<float>(footprint_ao_rays(options_)));
  ao.t_max =
      options_.ao_distance > 0 ? options_.ao_distance : std::numeric_limits<float>::infinity();
  ao.seed = options_.seed;
  ao.shaded = shaded_;
  ao.viewpoint = viewpoint_;
  ao_ray_pass(context_, queues, ao);
  OcclusionParams params = occlusion_of(hits, ao_rays_);
  set_falloff(params, options_.ao_distance, options_.ao_falloff);
  return params;
}

OcclusionParams PictureRays::make_light(const Queues& queues, std::uint32_t light,
                                        std::uint32_t hits) const {
  LightParams params{};
  params.point_count = hits;
  params.rays = static_cast<uint>(light_rays_);
  params.inverse_count = 1.0f / (static_cast<float>(footprint_samples(options_)) *
                                 static_cast<float>(options_.light_rays));
  params.light = light;
  params.seed = options_.seed;
  params.shaded = shaded_;
  params.viewpoint = viewpoint_;
  light_ray_pass(context_, scene_, queues, params);
  return occlusion_of(hits, light_rays_);
}

OcclusionParams PictureRays::occlusion_of(std::uint32_t points, int rays) const {
  OcclusionParams params =
      occlusion_params(scene_, points, static_cast<std::size_t>(rays), options_.footprint);
  if (options_.estimator == Estimator::exact) params.roulette = options_.roulette;
  return params;
}

}  // namespace dapple
