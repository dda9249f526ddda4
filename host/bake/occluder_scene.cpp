#include "bake/occluder_scene.hpp"

#include <fmt/format.h>

#include <map>

#include "bake/bake_bias.hpp"
#include "bake/samples/surface_samples.hpp"
#include "device/programs/kernels_ahead.hpp"
#include "passes/kernel_list.hpp"
#include "render/stopwatch.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

/// Appends the meshes, materials, textures and instances of `other` to `scene`; not its lights and
/// cameras.
void append_scene(Scene& scene, const Scene& other) {
  const auto textures = static_cast<int>(scene.textures.size());
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  const auto meshes = static_cast<std::uint32_t>(scene.meshes.size());
  scene.textures.insert(scene.textures.end(), other.textures.begin(), other.textures.end());
  for (Material material : other.materials) {
    if (material.alpha_texture >= 0) material.alpha_texture += textures;
    scene.materials.push_back(std::move(material));
  }
  for (Mesh mesh : other.meshes) {
    for (std::uint32_t& material : mesh.materials) material += materials;
    scene.meshes.push_back(std::move(mesh));
  }
  for (Instance instance : other.instances) {
    instance.mesh += meshes;
    instance.light = -1;
    scene.instances.push_back(instance);
  }
}

/// Those of vertices and textures; instances' kernels are compiled when they are launched.
std::vector<KernelName> kernels_of(const DeviceContext& context, const BakeOptions& options) {
  if (!options.vertices && !options.texture) return {};
  PointQuery query;
  query.estimator = options.estimator;
  query.measures_bias = has_bias(options) && (options.report_bias > 0 || options.max_bias > 0 ||
                                              options.target_error > 0);
  query.ao = !options.bent;
  query.bent = options.bent;
  query.rays = kRaysPerSample;
  if (options.target_error <= 0)
    query.rays = sample_counts(options.rays, 1, options.at_vertices).rays;
  std::vector<KernelName> kernels = point_kernels(context, query);
  if (options.normals == Normals::shading) {  // free_shifts()
    PointQuery shifts;
    shifts.estimator = Estimator::exact;
    shifts.given_rays = true;
    shifts.rays = 1;
    for (KernelName& kernel : point_kernels(context, shifts)) kernels.push_back(std::move(kernel));
  }
  if (options.light) {
    query.ao = query.bent = false;
    query.light = true;
    query.rays = options.light_rays;
    for (KernelName& kernel : point_kernels(context, query)) kernels.push_back(std::move(kernel));
  }
  return kernels;
}

}  // namespace

OccluderScene::OccluderScene(const Device& on, Scene scene, const BakeOptions& options,
                             const std::vector<Scene>& others)
    : device(on) {
  check_scene(scene);
  for (const Scene& other : others) check_scene(other);
  KernelsAhead kernels(device.context(), kernels_of(device.context(), options));
  if (!options.light || options.lights) {
    scene.lights = options.light ? *options.lights : std::vector<Light>{};
    for (Instance& instance : scene.instances) instance.light = -1;
  }
  for (const Scene& other : others) {
    append_scene(scene, other);
    notes.insert(notes.end(), other.warnings.begin(), other.warnings.end());
    if (options.light && !other.lights.empty())
      notes.push_back(fmt::format("{}: its {} light{} not baked: occluders only hide", other.source,
                                  other.lights.size(), other.lights.size() == 1 ? " is" : "s are"));
  }
  for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
  if (options.ground) add_ground(scene);
  merge_single_instances(scene);
  finalize_domes(scene);
  lights = scene.lights;
  const Stopwatch building;
  bvh = build_bvh(scene, options.cache);
  build_seconds = building.seconds();
  const Stopwatch uploading;
  uploaded = upload(device, scene, bvh);
  upload_seconds = uploading.seconds();
  const Stopwatch compiling;
  kernels.finish();
  kernel_seconds = compiling.seconds();
  for (std::string& warning : scene.warnings) notes.push_back(std::move(warning));
  closed = std::make_unique<ClosedGeometry>(std::move(scene));
}

Scene scene_of_mesh(const Scene& scene, std::size_t mesh) {
  Scene alone;
  alone.source = scene.source;
  alone.materials = scene.materials;
  alone.meshes = {scene.meshes[mesh]};
  std::vector<bool> uses(scene.materials.size());
  for (const std::uint32_t material : alone.meshes[0].materials) uses[material] = true;
  std::map<int, int> numbers;  // of textures
  for (std::size_t m = 0; m < uses.size(); ++m) {
    Material& material = alone.materials[m];
    material.color_texture = -1;
    if (material.alpha_texture < 0) continue;
    if (!uses[m]) {
      material.alpha_texture = -1;
      continue;
    }
    const auto [known, is_new] =
        numbers.try_emplace(material.alpha_texture, static_cast<int>(numbers.size()));
    if (is_new)
      alone.textures.push_back(scene.textures[static_cast<std::size_t>(material.alpha_texture)]);
    material.alpha_texture = known->second;
  }
  alone.instances.resize(1);
  return alone;
}

}  // namespace dapple
