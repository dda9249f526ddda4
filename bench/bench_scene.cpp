// Prepares a measured scene as render() does, up to the rays of the occlusion pass. The rays stay
// in the queues, so that benchmarks can trace them repeatedly.
#include "bench_scene.hpp"

#include <limits>

#include "dapple/error.hpp"
#include "passes/camera_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/ray_packets.hpp"
#include "sampling/sample_plan.hpp"

namespace dapple::bench {
namespace {

/// About 10,000 points and 150,000 AO rays: so few that a launch takes some tenths of a second, and
/// so many that the overhead of a launch does not matter.
constexpr int kWidth = 384;
constexpr int kHeight = 240;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

RenderOptions picture_options() {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = 1;
  options.light = false;
  return options;
}

/// Runs the renderer's passes up to the occlusion pass. Camera rays and AO rays are in separate
/// queues, so that either pass can run again.
SceneRays make_rays(DeviceContext& context, const DeviceBuffers& scene, const View& view) {
  SceneRays rays;
  rays.camera = make_queues(context, kPixels, 1);
  rays.camera_count = kPixels;
  const RenderOptions options = picture_options();
  const std::vector<PixelWork> work =
      SamplePlan(view.width, view.height, options).least().front().work;
  rays.camera.work = context.allocate(work.size() * sizeof(PixelWork));
  context.write(rays.camera.work, work.data(), work.size() * sizeof(PixelWork));
  CameraParams camera = camera_params(view, options, scene.bounds);
  camera.slice = {0, static_cast<uint>(kPixels), 0, 1};
  camera_pass(context, scene, rays.camera, camera);
  const std::uint32_t hits = compact_pass(context, rays.camera, kPixels);
  if (hits == 0) throw Error(ErrorKind::failed, "the camera sees nothing of the scene");
  rays.ao_count = std::size_t{hits} * kRaysPerPoint;
  rays.ao = rays.camera;
  rays.ao.rays = context.allocate(rays.ao_count * sizeof(Ray));
  rays.ao.occlusions = context.allocate(rays.ao_count * sizeof(Occlusion));
  if (traces_scalar(context)) rays.ao.order = context.allocate(rays.ao_count * sizeof(uint));
  AoParams params{};
  params.point_count = hits;
  params.rays = kRaysPerPoint;
  params.inverse_count = 1.0f / kRaysPerPoint;
  params.t_max = std::numeric_limits<float>::infinity();
  ao_ray_pass(context, rays.ao, params);
  context.finish();
  return rays;
}

/// A dome that is brighter towards the zenith, with a sun of a few texels.
Light sky() {
  Environment image{1024, 512, {}};
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const bool sun = y >= 128 && y < 132 && x >= 256 && x < 260;
      const float above = 1.0f - static_cast<float>(y) / static_cast<float>(image.height);
      image.radiance.emplace_back(sun ? 1e4f : above);
    }
  }
  Light dome;
  dome.name = "sky";
  dome.kind = LightKind::dome;
  dome.environment = std::make_shared<const Environment>(std::move(image));
  return dome;
}

}  // namespace

std::vector<SceneRecipe> named_scenes() {
  return {{"tree", "scene:tree?leaves=50000", {}},
          {"tree-thin", "scene:tree?leaves=50000&opacity=0.2", {}},
          {"cloud", "scene:cloud?leaves=50000", {}},
          {"forest", "scene:forest?trees=100&leaves=20000", {}},
          {"hair", "scene:hair", {}}};
}

const Scene& BenchScene::scene() {
  if (scene_) return *scene_;
  Scene scene = load_scene(recipe_.spec);
  for (const auto& [material, value] : recipe_.opacity) override_opacity(scene, material, value);
  const RenderOptions options = picture_options();
  std::vector<std::string> notes;
  // As in render(), the camera is chosen before meshes are merged.
  view_ = choose_view(scene, options, notes);
  merge_single_instances(scene);
  scene.lights = {sky()};
  finalize_domes(scene);
  return scene_.emplace(std::move(scene));
}

const SceneBvh& BenchScene::bvh() {
  if (!bvh_) bvh_ = build_bvh(scene());
  return *bvh_;
}

const DeviceScene& BenchScene::on_device() {
  if (!on_device_) on_device_ = upload(device(), scene(), bvh());
  return *on_device_;
}

CameraParams BenchScene::camera() {
  return camera_params(view_, picture_options(), on_device().buffers->bounds);
}

const SceneRays& BenchScene::rays() {
  if (!rays_) rays_ = make_rays(device().context(), *on_device().buffers, view_);
  return *rays_;
}

}  // namespace dapple::bench
