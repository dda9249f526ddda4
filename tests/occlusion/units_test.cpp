// AO is a ratio: it does not depend on the unit of length, neither that of the world nor that of a
// mesh. Squares of areas exceed a float where boxes have 1e10 units.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// 600 squares of a tenth of the canopy's half width, in a cube of 2 `size` above the origin.
Mesh canopy(float size) {
  scene_test::Points random(3);
  Mesh mesh;
  for (int i = 0; i < 600; ++i) {
    const V3f at = (random.in_cube(1) + V3f(0, 1.2f, 0)) * size;
    const V3f normal = random.on_sphere();
    const V3f u = normal.cross(random.on_sphere()).normalized() * (0.1f * size);
    append_grid(mesh, at, u, normal.cross(u), 1, 0);
  }
  return mesh;
}

/// Means at points below the canopy: AO of points that trace rays one by one, several together, and
/// each point's together.
std::vector<double> mean_ao(const Scene& scene, float size) {
  const SceneOnDevice on(scene);
  std::vector<double> means;
  for (const int rays : {3, 12, 64}) {
    scene_test::Points random(9);
    std::vector<V3f> points, normals(256, V3f(0, 1, 0));
    for (int i = 0; i < 256; ++i)
      points.push_back(V3f(2 * random.unit() - 1, 0, 2 * random.unit() - 1) * size);
    OcclusionOptions options;
    options.rays = rays;
    options.estimator = Estimator::prefiltered;
    options.footprint = 4;
    double sum = 0;
    for (const float ao : occlusion(device(), on.uploaded, points, normals, options)) sum += ao;
    means.push_back(sum / 256);
  }
  return means;
}

Scene one_canopy(float size) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, canopy(size));
  return scene;
}

// The same random numbers, and sizes that are powers of two: only guards against divisions by zero
// differ.
TEST(Units, TheSizeOfTheWorldDoesNotChangeAo) {
  const std::vector<double> metres = mean_ao(one_canopy(1), 1);
  EXPECT_GT(metres[0], 0.2);
  EXPECT_LT(metres[0], 0.8);
  for (const float size : {0x1p27f, 0x1p-23f}) {
    const std::vector<double> found = mean_ao(one_canopy(size), size);
    for (std::size_t i = 0; i < metres.size(); ++i)
      EXPECT_NEAR(found[i], metres[i], 0.001) << size << ", case " << i;
  }
}

/// The canopy twice, in units of which a metre has `per_metre`.
Scene instances(float per_metre) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, canopy(8 * per_metre));
  scene.instances.push_back(scene.instances[0]);
  for (std::size_t i = 0; i < 2; ++i) {
    scene.instances[i].to_world.setScale(1 / per_metre);
    scene.instances[i].to_world[3][0] = i == 0 ? 0.0f : 16.0f;
  }
  return scene;
}

// Micrometres and nanometres, nearly.
TEST(Units, TheUnitsOfAMeshDoNotChangeAo) {
  const std::vector<double> metres = mean_ao(instances(1), 8);
  for (const float per_metre : {0x1p20f, 0x1p30f}) {
    const std::vector<double> found = mean_ao(instances(per_metre), 8);
    for (std::size_t i = 0; i < metres.size(); ++i)
      EXPECT_NEAR(found[i], metres[i], 0.001) << per_metre << ", case " << i;
  }
}

}  // namespace
}  // namespace dapple
