// Reads punctual lights: see light.hpp.
#include "scene/gltf/light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// Above this limit, products with areas and numbers of samples exceed float's range.
constexpr double kLargestIntensity = 1e20;

/// Returns intensity * color. glTF's intensities are photometric (candela, lux); dapple uses the
/// same numbers as radiometric ones (W/sr, W/m^2).
V3f intensity_of(const tinygltf::Light& light) {
  V3f result;
  for (int channel = 0; channel < 3; ++channel) {
    const double color =
        light.color.size() == 3 ? light.color[static_cast<std::size_t>(channel)] : 1.0;
    result[channel] = static_cast<float>(std::min(light.intensity * color, kLargestIntensity));
  }
  return result;
}

void make_sun(Light& light, V3f irradiance) {
  light.kind = LightKind::sun;
  // The irradiance of a surface that faces a disk of radiance L is L * pi * sin^2(angular radius).
  const float sine = std::sin(light.angular_radius);
  light.radiance = irradiance / (std::numbers::pi_v<float> * sine * sine);
}

void make_sphere(Light& light, V3f intensity, float radius) {
  light.kind = LightKind::sphere;
  light.radius = radius;
  light.radiance = intensity / (std::numbers::pi_v<float> * radius * radius);
}

void check_cone(const tinygltf::SpotLight& spot, const std::string& who, const std::string& file) {
  const bool sound = spot.innerConeAngle >= 0 && spot.innerConeAngle <= spot.outerConeAngle &&
                     spot.outerConeAngle > 0 && spot.outerConeAngle <= std::numbers::pi / 2 + 1e-4;
  if (sound) return;
  fail(file,
       "{} has the inner cone angle {} and the outer {}; it must be 0 <= inner <= outer <= pi/2, "
       "with an outer above 0",
       who, spot.innerConeAngle, spot.outerConeAngle);
}

/// Cosines of smaller angles are too coarse as floats.
constexpr double kLeastOuterAngle = 0.2 * std::numbers::pi / 180;

void make_cone(Light& light, const tinygltf::SpotLight& spot) {
  const double outer = std::max(spot.outerConeAngle, kLeastOuterAngle);
  light.cos_inner = static_cast<float>(std::cos(spot.innerConeAngle));
  light.cos_outer = static_cast<float>(std::max(std::cos(outer), 0.0));
}

/// Takes position and direction from the node; its scale changes neither radius nor intensity, but
/// one of zero, which leaves no direction, makes the light dark: returns false.
bool place(Light& light, const Imath::M44d& to_world) {
  light.position = V3f(Imath::V3d(to_world[3][0], to_world[3][1], to_world[3][2]));
  const Imath::V3d minus_z(-to_world[2][0], -to_world[2][1], -to_world[2][2]);
  if (minus_z.length() == 0) return false;
  light.direction = V3f(minus_z.normalized());
  return true;
}

void add_light(const Document& document, const PlacedNode& placed, int index,
               const SceneOptions& options, Scene& scene) {
  const auto& given = document.model.lights[static_cast<std::size_t>(index)];
  const auto& node = document.model.nodes[static_cast<std::size_t>(placed.node)];
  const std::string who = element("light", static_cast<std::size_t>(index), given.name);
  const V3f intensity = intensity_of(given);
  if (std::max({intensity.x, intensity.y, intensity.z}) >= static_cast<float>(kLargestIntensity))
    scene.warnings.push_back(one_line(fmt::format("{}: {} is brighter than {:g}: it gets that",
                                                  document.file, who, kLargestIntensity)));
  Light light;
  light.name = one_line(!given.name.empty()  ? given.name
                        : !node.name.empty() ? node.name
                                             : fmt::format("light_{}", index));
  if (given.type == "spot" && given.spot.outerConeAngle < kLeastOuterAngle)
    scene.warnings.push_back(one_line(fmt::format(
        "{}: {} has an outer cone angle below 0.2 degrees: it gets that", document.file, who)));
  if (given.type == "directional") {
    make_sun(light, intensity);
  } else {
    make_sphere(light, intensity, options.light_radius);
    if (given.type == "spot") make_cone(light, given.spot);
  }
  if (!place(light, placed.to_world)) {
    // In a file that moves it stays, so that all frames of a sequence have the same layers.
    const bool moves = !document.motion.clips.empty();
    scene.warnings.push_back(one_line(fmt::format("{}: {} is {}: its node is scaled to nothing",
                                                  document.file, who, moves ? "dark" : "ignored")));
    if (!moves) return;
    light.radiance = V3f(0, 0, 0);
  }
  scene.lights.push_back(std::move(light));
}

/// Shadows of spheres that are large for their scene are soft, or none.
void warn_of_large_spheres(const std::string& file, Scene& scene) {
  constexpr float kLarge = 0.1f;  // of the scene's diagonal
  const auto found = std::find_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return light.kind == LightKind::sphere;
  });
  if (found == scene.lights.end()) return;
  const Box3f bounds = scene_bounds(scene);
  const float diagonal = bounds.isEmpty() ? 0.0f : bounds.size().length();
  if (!(diagonal > 0) || found->radius <= kLarge * diagonal) return;
  scene.warnings.push_back(one_line(
      fmt::format("{}: light \"{}\" is a sphere of {:g} m in a scene {:.2g} m across: its shadows "
                  "are soft; --light-radius sets another",
                  file, found->name, found->radius, diagonal)));
}

}  // namespace

void add_punctual_lights(const Document& document, const std::vector<PlacedNode>& placed,
                         const SceneOptions& options, Scene& scene) {
  for (std::size_t i = 0; i < document.model.lights.size(); ++i) {
    const auto& given = document.model.lights[i];
    if (given.type == "spot")
      check_cone(given.spot, element("light", i, given.name), document.file);
  }
  for (const PlacedNode& at : placed) {
    const auto& node = document.model.nodes[static_cast<std::size_t>(at.node)];
    const auto light = node.extensions.find(extension::kLights);
    if (light == node.extensions.end()) continue;
    add_light(document, at, light->second.Get("light").GetNumberAsInt(), options, scene);
  }
  warn_of_large_spheres(document.file, scene);
}

}  // namespace dapple::gltf
