// Scenes for tests that compare how rays are traced: textured cards, and instances under odd
// scales.
#pragma once

#include "support/scenes/scene_on_device.hpp"

namespace dapple::scene_test {

// Cards rotated about the vertical, with a chequered alpha, both alpha-blended and cut out.
inline Scene textured_cards() {
  Scene scene;
  scene.source = "cards";
  Texture chequers;
  chequers.width = chequers.height = 8;
  for (int i = 0; i < 64; ++i) chequers.alpha.push_back((i + i / 8) % 2 ? 220 : 30);
  scene.textures.push_back(chequers);
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    Material material = material_of(1);
    material.alpha_mode = mode;
    material.alpha_texture = 0;
    scene.materials.push_back(material);
  }
  Points random(4);
  Mesh mesh;
  for (std::uint32_t card = 0; card < 200; ++card) {
    const V3f corner = random.in_cube(2), side = random.on_sphere();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V2f& uv : {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)}) {
      mesh.positions.push_back(corner + side * uv.x + V3f(0, uv.y, 0));
      mesh.uvs.push_back(uv);
    }
    mesh.indices.insert(mesh.indices.end(),
                        {first, first + 1, first + 2, first, first + 2, first + 3});
    mesh.materials.insert(mesh.materials.end(), {card % 2, card % 2});
  }
  place(scene, std::move(mesh));
  return scene;
}

// Trees of which every second one is mirrored and scaled non-uniformly.
inline Scene forest_scaled_non_uniformly() {
  Scene scene = make_procedural("scene:forest?trees=9&leaves=500&opacity=0.5");
  M44f scale;
  scale.setScale(V3f(-3, 1, 2));
  for (std::size_t i = 0; i < scene.instances.size(); i += 2) {
    scene.instances[i].to_world = scale * scene.instances[i].to_world;
  }
  return scene;
}

}  // namespace dapple::scene_test
