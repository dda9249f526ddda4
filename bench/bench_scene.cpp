#include "bench_scene.hpp"

#include <limits>

#include "dapple/error.hpp"
#include "device/context.hpp"
#include "wavefront/passes.hpp"
#include "wavefront/view.hpp"

namespace dapple::bench {
namespace {

/// Small enough for a launch of a few tenths of a second, large enough that launching costs
/// nothing: about 20,000 points and 300,000 AO rays.
constexpr int kWidth = 256;
constexpr int kHeight = 160;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

RenderOptions picture_options() {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = 1;
  options.light = false;
  return options;
}

std::vector<Ray> read_rays(DeviceContext& context, const Queues& queues, std::size_t count) {
  std::vector<Ray> rays(count);
  context.read(queues.rays, rays.data(), count * sizeof(Ray));
  return rays;
}

/// Runs the renderer's own passes up to the occlusion pass, and keeps their rays.
SceneRays make_rays(const Device& device, const DeviceBuffers& scene, CameraParams camera) {
  DeviceContext& context = device.context();
  const Queues queues = make_queues(context, kPixels, kRaysPerPoint);
  SceneRays rays;
  camera.slice = {0, static_cast<uint>(kPixels), 0, 1};
  camera_pass(context, queues, camera);
  rays.camera = read_rays(context, queues, kPixels);
  closest_hit_pass(context, scene, queues, kPixels);
  const std::uint32_t hits = compact_pass(context, queues, kPixels);
  if (hits == 0) throw Error(ErrorKind::failed, "the camera sees nothing of the scene");
  ao_ray_pass(
      context, queues,
      {hits, kRaysPerPoint, 1.0f / kRaysPerPoint, std::numeric_limits<float>::infinity(), 0u});
  rays.ao = read_rays(context, queues, std::size_t{hits} * kRaysPerPoint);
  context.finish();
  return rays;
}

}  // namespace

std::vector<SceneRecipe> named_scenes() {
  return {{"tree", "scene:tree?leaves=50000", {}},
          {"tree-thin", "scene:tree?leaves=50000&opacity=0.2", {}},
          {"cloud", "scene:cloud?leaves=50000", {}},
          {"forest", "scene:forest?trees=100&leaves=20000", {}}};
}

const Scene& BenchScene::scene() {
  if (scene_) return *scene_;
  Scene scene = load_scene(recipe_.spec);
  for (const auto& [material, value] : recipe_.opacity) override_opacity(scene, material, value);
  const RenderOptions options = picture_options();
  std::vector<std::string> notes;
  // As render() does, the camera is chosen before merging touches the scene.
  camera_ = camera_params(choose_view(scene, options, notes), options);
  merge_single_instances(scene);
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

const SceneRays& BenchScene::rays() {
  if (!rays_) rays_ = make_rays(device(), *on_device().buffers, *camera_);
  return *rays_;
}

}  // namespace dapple::bench
