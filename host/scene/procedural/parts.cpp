// What procedural scenes have in common: materials, the length of leaves, meshes that are placed.
#include "dapple/error.hpp"
#include "scene/procedural/scenes.hpp"

namespace dapple {
namespace {

/// Base colours, linear, of what grows and what it stands on. Other materials are white.
V3f color_named(const std::string& name) {
  if (name == "leaf") return {0.11f, 0.22f, 0.04f};
  if (name == "bark") return {0.14f, 0.10f, 0.07f};
  if (name == "ground") return {0.32f, 0.29f, 0.24f};
  if (name == "hair") return {0.16f, 0.08f, 0.035f};
  if (name == "skin") return {0.58f, 0.36f, 0.26f};
  return {1, 1, 1};
}

}  // namespace

float given_leaf_length(const ProceduralParameters& parameters) {
  const float length = parameters.real("leaf_size");
  if (length > 0 && length < 0.001f) {
    throw Error(ErrorKind::usage,
                parameters.scene() + ": leaf_size must be 0 (automatic) or at least 0.001 m");
  }
  return length;
}

Material blend_material(const std::string& name, float opacity) {
  Material material;
  material.name = name;
  material.color = color_named(name);
  material.alpha_mode = AlphaMode::blend;
  material.alpha = opacity;
  material.double_sided = true;
  return material;
}

Material opaque_material(const std::string& name) {
  Material material;
  material.name = name;
  material.color = color_named(name);
  return material;
}

void place(Scene& scene, Mesh mesh) {
  Instance instance;
  instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back(instance);
}

}  // namespace dapple
