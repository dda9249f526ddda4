#include "passes/warm_up.hpp"

#include <functional>
#include <map>

#include "dapple/error.hpp"
#include "device/upload/scene_upload.hpp"
#include "passes/back_pass.hpp"
#include "passes/camera_pass.hpp"
#include "passes/light_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "passes/resolve_pass.hpp"
#include "passes/shading_pass.hpp"

namespace dapple {
namespace {

/// Arguments of passes, with the smallest buffers.
struct EmptyStage {
  explicit EmptyStage(const Device& device)
      : context(device.context()),
        scene(device),
        queues(make_queues(context, 0, 0)),
        gathered(make_queues(context, 0, 0)),
        slots(context.allocate(0)) {
    for (Buffer* buffer :
         {&scene.nodes, &scene.blocks, &scene.segments, &scene.textured, &scene.materials,
          &scene.texels, &scene.instances, &scene.normals, &scene.color_words,
          &scene.color_materials, &scene.color_texels, &scene.lights, &scene.emitters,
          &scene.environments, &queues.work, &film.sums, &film.squares})
      *buffer = context.allocate(0);
  }

  DeviceContext& context;
  DeviceBuffers scene;
  Queues queues, gathered;
  Buffer slots;
  FilmBuffers film;
};

Estimator estimator_of(const Variant& variant) {
  return variant.prefiltered ? Estimator::prefiltered : Estimator::exact;
}

void warm_up_occlusion(EmptyStage& s, Packets with, const Variant& variant) {
  OcclusionParams params{};
  params.rays_per_point = 1;
  occlusion_pass_with(with, s.context, s.queues, s.scene, "occlusion", estimator_of(variant),
                      params);
}

void warm_up_camera(EmptyStage& s, const Variant& variant) {
  CameraParams params{};
  params.orthographic = !variant.shared_origin;
  camera_pass(s.context, s.scene, s.queues, params);
}

void warm_up_points(EmptyStage& s, const Variant& variant) {
  OcclusionParams params{};
  params.rays_per_point = 1;
  point_ao_pass(s.context, s.queues, s.scene, estimator_of(variant), {}, params);
}

void warm_up_shading(EmptyStage& s, const Variant&) {
  shading_pass(s.context, s.scene, s.queues, s.film, {}, {}, 1);
}

using Pass = std::function<void(EmptyStage&, const Variant&)>;

const std::map<std::string, Pass>& passes() {
  static const std::map<std::string, Pass> kOfKernel{
      {"camera_hits", warm_up_camera},
      {"camera_hits_scalar", warm_up_camera},
      {"closest_hit",
       [](EmptyStage& s, const Variant&) { closest_hit_pass(s.context, s.scene, s.queues, 0); }},
      {"count_hits", [](EmptyStage& s, const Variant&) { compact_pass(s.context, s.queues, 0); }},
      {"compact_hits", [](EmptyStage& s, const Variant&) { compact_pass(s.context, s.queues, 0); }},
      {"ao_rays_scalar",
       [](EmptyStage& s, const Variant&) { ao_ray_pass(s.context, s.queues, {}); }},
      {"light_rays_scalar",
       [](EmptyStage& s, const Variant&) { light_ray_pass(s.context, s.scene, s.queues, {}); }},
      {"ao_rays", [](EmptyStage& s, const Variant&) { ao_ray_pass(s.context, s.queues, {}); }},
      {"light_rays",
       [](EmptyStage& s, const Variant&) { light_ray_pass(s.context, s.scene, s.queues, {}); }},
      {"occlusion",
       [](EmptyStage& s, const Variant& v) { warm_up_occlusion(s, Packets::none, v); }},
      {"occlusion_scalar",
       [](EmptyStage& s, const Variant& v) { warm_up_occlusion(s, Packets::scalar, v); }},
      {"order_rays",
       [](EmptyStage& s, const Variant& v) { warm_up_occlusion(s, Packets::scalar, v); }},
      {"packet",
       [](EmptyStage& s, const Variant& v) {
         warm_up_occlusion(s, v.shared_origin ? Packets::point : Packets::pixel, v);
       }},
      {"gather_rays",
       [](EmptyStage& s, const Variant&) {
         gather_pass(s.context, s.queues, s.slots, s.gathered, 0, 1, 0);
       }},
      {"sum_rays",
       [](EmptyStage& s, const Variant&) { sum_rays_pass(s.context, s.queues, s.slots, 0, 1); }},
      {"point_ao", warm_up_points},
      {"resolve_surface",
       [](EmptyStage& s, const Variant&) {
         resolve_surface_pass(s.context, s.queues, s.film, {});
       }},
      {"flip_points",
       [](EmptyStage& s, const Variant&) { flip_points_pass(s.context, s.queues, s.queues, {}); }},
      {"count_backs",
       [](EmptyStage& s, const Variant&) { count_backs_pass(s.context, s.queues, s.film, {}); }},
      {"shade_points", warm_up_shading},
      {"shade_points_scalar", warm_up_shading},
      {"resolve_ao",
       [](EmptyStage& s, const Variant&) { resolve_ao_pass(s.context, s.queues, s.film, {}); }},
      {"resolve_light",
       [](EmptyStage& s, const Variant&) { resolve_light_pass(s.context, s.queues, s.film, {}); }},
      {"resolve_dome",
       [](EmptyStage& s, const Variant&) {
         resolve_dome_pass(s.context, s.scene, s.queues, s.film, {}, 0);
       }},
  };
  return kOfKernel;
}

}  // namespace

bool can_warm_up(const KernelName& kernel) { return passes().contains(kernel.name); }

void warm_up(const Device& device, const std::vector<KernelName>& kernels) {
  EmptyStage stage(device);
  stage.context.warm_up();
  for (const KernelName& kernel : kernels) {
    if (!can_warm_up(kernel)) throw Error(ErrorKind::usage, "no kernel: '" + kernel.name + "'");
    passes().at(kernel.name)(stage, kernel.variant);
  }
  stage.context.finish();
}

}  // namespace dapple
