// Hair for tests: strands of random length and curl that start on a ball, of one material each.
#pragma once

#include <cmath>
#include <numbers>

#include "support/scene_on_device.hpp"

namespace dapple::scene_test {

struct Curls {
  std::size_t strands = 500;
  std::size_t segments = 16;  ///< of each
  float radius = 0.002f;      ///< at the root, metres; the tip has `tip` of it
  float tip = 1.0f;
  float tickets = 2;  ///< of a strand around its way
  std::uint32_t seed = 1;
};

/// Around a ball of radius 0.3, strands 0.3 to 0.7 long.
inline Mesh curly_strands(const Curls& curls, std::uint32_t material = 0) {
  Points random(curls.seed);
  Mesh mesh;
  for (std::size_t s = 0; s < curls.strands; ++s) {
    const V3f way = random.on_sphere();
    const V3f side = way.cross(random.on_sphere()).normalized(), up = way.cross(side);
    const float length = 0.3f + 0.4f * random.unit(), curl = 0.02f + 0.04f * random.unit();
    for (std::size_t i = 0; i <= curls.segments; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(curls.segments);
      const float angle = 2 * static_cast<float>(kPi) * curls.tickets * share;
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

/// One instance of `mesh`, its material of `opacity`.
inline Scene strand_scene(Mesh mesh, float opacity) {
  Scene scene;
  scene.source = "strands";
  scene.materials.push_back(material_of(opacity));
  place(scene, std::move(mesh));
  return scene;
}

}  // namespace dapple::scene_test
