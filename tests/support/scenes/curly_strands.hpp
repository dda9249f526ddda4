// Hair for tests. In: number, thickness and curl of the strands; out: a mesh of strands that start
// on a ball, with random lengths and curls and one material, or a scene with that mesh.
#pragma once

#include <cmath>
#include <numbers>

#include "support/scenes/scene_on_device.hpp"

namespace dapple::scene_test {

struct Curls {
  std::size_t strands = 500;
  std::size_t segments = 16;  ///< of each strand
  float radius = 0.002f;      ///< at the root, metres
  float tip = 1.0f;           ///< radius at the tip as a share of the root's
  float turns = 2;            ///< full turns of a strand's helix around its axis
  std::uint32_t seed = 1;
};

/// Strands of 0.3 to 0.7 m that start on a ball of radius 0.3 m.
inline Mesh curly_strands(const Curls& curls, std::uint32_t material = 0) {
  Points random(curls.seed);
  Mesh mesh;
  for (std::size_t s = 0; s < curls.strands; ++s) {
    const V3f way = random.on_sphere();
    const V3f side = way.cross(random.on_sphere()).normalized(), up = way.cross(side);
    const float length = 0.3f + 0.4f * random.unit(), curl = 0.02f + 0.04f * random.unit();
    for (std::size_t i = 0; i <= curls.segments; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(curls.segments);
      const float angle = 2 * static_cast<float>(kPi) * curls.turns * share;
      const auto at = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(way * (0.3f + length * share) +
                               (side * std::sin(angle) + up * (std::cos(angle) - 1)) * curl);
      mesh.radii.push_back(curls.radius * (1 + (curls.tip - 1) * share));
      if (i == 0) continue;
      mesh.indices.insert(mesh.indices.end(), {at - 1, at});
      mesh.materials.push_back(material);
    }
  }
  return mesh;
}

/// A scene of one instance of `mesh`; its material has `opacity`.
inline Scene strand_scene(Mesh mesh, float opacity) {
  Scene scene;
  scene.source = "strands";
  scene.materials.push_back(material_of(opacity));
  place(scene, std::move(mesh));
  return scene;
}

}  // namespace dapple::scene_test
