// Changes of a scene after it was loaded: the opacity of a material, other lights, and a ground
// under the scene. In and out: a scene.
#include <fmt/format.h>

#include <algorithm>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/ground.hpp"
#include "scene/procedural/mesh_shapes.hpp"

namespace dapple {
namespace {

/// So that the horizon looks level, and little of the sky below it shows.
constexpr float kGroundWidth = 200;

std::string list_materials(const Scene& scene) {
  std::string names;
  for (const Material& material : scene.materials) {
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", material.name);
  }
  return names.empty() ? "none" : names;
}

}  // namespace

void override_opacity(Scene& scene, const std::string& name, float value) {
  if (!(value >= 0 && value <= 1)) {
    throw Error(ErrorKind::usage,
                fmt::format("opacity of material \"{}\" is {}, outside [0, 1]", name, value));
  }
  bool found = false;
  for (Material& material : scene.materials) {
    if (material.name != name) continue;
    found = true;
    material.alpha_mode = AlphaMode::blend;
    material.alpha = value;
    material.alpha_texture = -1;
    material.uses_vertex_alpha = false;
  }
  if (!found) {
    throw Error(ErrorKind::usage, fmt::format("{}: there is no material \"{}\"; there are: {}",
                                              source_name(scene), name, list_materials(scene)));
  }
}

void use_lights(Scene& scene, const std::vector<Light>& lights) {
  for (Instance& instance : scene.instances) instance.light = -1;
  scene.lights = lights;
  for (const Light& light : lights)
    if (light.environment) scene.files.push_back(light.environment->file);
}

void add_ground(Scene& scene) { add_ground(scene, bounds_to_stand_on(scene)); }

float ground_height(const Box3f& bounds) {
  const V3f size = bounds.size();
  const float drop = 1e-5f * std::max({size.x, size.y, size.z});
  return bounds.min.y - drop;
}

void add_ground(Scene& scene, const Box3f& bounds, std::optional<float> height) {
  if (bounds.isEmpty()) {
    throw Error(ErrorKind::input,
                fmt::format("{}: there is nothing to put a ground under", source_name(scene)));
  }
  const V3f size = bounds.size();
  float width = std::max(size.x, size.z);
  if (width <= 0) width = std::max(size.y, 1.0f);

  Mesh ground;
  ground.name = "ground";
  append_square(ground, kGroundWidth * width, 0,
                static_cast<std::uint32_t>(scene.materials.size()));
  Instance instance;
  instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  const float y = height.value_or(ground_height(bounds));
  instance.to_world.setTranslation(V3f(bounds.center().x, y, bounds.center().z));

  Material material;
  material.name = "ground";
  material.color = V3f(0.5f);
  scene.materials.push_back(material);
  scene.meshes.push_back(std::move(ground));
  scene.instances.push_back(instance);
}

}  // namespace dapple
