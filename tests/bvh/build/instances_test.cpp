// Instances that are turned, mirrored, scaled non-uniformly, sheared, or that overlap. They must
// occlude as their triangles in world space do.
#include <gtest/gtest.h>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Scene tree(float opacity) {
  return make_procedural("scene:tree?leaves=1500&opacity=" + std::to_string(opacity));
}

Scene placed(Scene scene, const std::vector<M44f>& transforms) {
  const Instance model = scene.instances.at(0);
  scene.instances.clear();
  for (const M44f& to_world : transforms) {
    scene.instances.push_back(model);
    scene.instances.back().to_world = to_world;
  }
  return scene;
}

// The triangles of all instances as one mesh in world space.
Scene flattened(const Scene& scene) {
  Scene flat = scene;
  flat.meshes.clear();
  flat.instances.clear();
  Mesh all;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const V3f& p : mesh.positions) all.positions.push_back(p * instance.to_world);
    for (const std::uint32_t i : mesh.indices) all.indices.push_back(first + i);
    all.materials.insert(all.materials.end(), mesh.materials.begin(), mesh.materials.end());
  }
  place(flat, std::move(all));
  return flat;
}

M44f turned(const V3f& euler_degrees) {
  M44f m;
  m.rotate(euler_degrees * static_cast<float>(kPi / 180));
  return m;
}

M44f scaled(const V3f& by) {
  M44f m;
  m.setScale(by);
  return m;
}

M44f moved(const V3f& by) {
  M44f m;
  m.setTranslation(by);
  return m;
}

struct Placing {
  const char* name;
  std::vector<M44f> transforms;
};

const std::vector<Placing>& placings() {
  M44f sheared;
  sheared.setShear(V3f(0.5f, 0.2f, -0.3f));
  static const std::vector<Placing> kPlacings{
      {"turned by 90 degrees", {turned({0, 90, 0})}},
      {"laid down", {turned({90, 0, 0}) * moved({3, 1, -2})}},
      {"mirrored and scaled", {scaled({-1, 0.5f, 2}) * turned({0, 30, 0})}},
      {"sheared", {sheared}},
      {"twice as large and three times as long", {scaled({2, 6, 2}) * turned({0, 20, 0})}},
      {"three overlapping",
       {moved({-1, 0, 0}), scaled({1, 1, -1}) * moved({1, 0, 0.5f}), turned({0, 45, 0})}},
  };
  return kPlacings;
}

TEST(Instance, OccludesRayByRayAsItsTrianglesInWorldSpace) {
  for (const Placing& placing : placings()) {
    SCOPED_TRACE(placing.name);
    const Scene scene = placed(tree(0.3f), placing.transforms);
    const SceneOnDevice instanced(scene), flat(flattened(scene));
    ASSERT_TRUE(instanced.bvh.has_top);
    ASSERT_FALSE(flat.bvh.has_top);
    const std::vector<Ray> rays = rays_through(flat.bvh.bounds, 10000, 15, 0, 11);
    const std::vector<Occlusion> a = instanced.trace(rays, Estimator::exact);
    const std::vector<Occlusion> b = flat.trace(rays, Estimator::exact);
    int different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      different += std::fabs(a[i].transmittance - b[i].transmittance) > 1e-5f;
    }
    // A ray that passes an edge within the rounding (1e-6 of 15 m) may be on one side of it in
    // object space and on the other in world space. Leaves have a size of some centimetres, and
    // about ten edges are near a ray.
    std::printf("%s: %d of %zu rays differ\n", placing.name, different, rays.size());
    EXPECT_LE(different, 10);
  }
}

TEST(Instance, OccludesPrefilteredInTheMeanAsItsTrianglesInWorldSpace) {
  for (const Placing& placing : placings()) {
    for (const float opacity : {0.3f, 0.85f}) {
      SCOPED_TRACE(testing::Message() << placing.name << ", opacity " << opacity);
      const Scene scene = placed(tree(opacity), placing.transforms);
      const SceneOnDevice instanced(scene), flat(flattened(scene));
      // Solid angles of AO rays when a point has 640, 64 or 4 of them. For wide rays a few nodes
      // represent the tree, and the model blends their opacities differently along the tree's own
      // axes and along the world's. At 0.8 sr one node represents an instance; the root of the
      // flattened scene never represents the whole scene.
      struct Width {
        float solid_angle;
        double relative_difference;
      };
      for (const auto& [solid_angle, tolerance] :
           {Width{0.005f, 0.02}, Width{0.05f, 0.06}, Width{0.8f, 0.12}}) {
        const std::vector<Ray> rays = rays_across(flat.bvh.bounds, 10000, solid_angle, 12);
        const double a = 1 - mean_transmittance(instanced.trace(rays, Estimator::prefiltered));
        const double b = 1 - mean_transmittance(flat.trace(rays, Estimator::prefiltered));
        const double exact = 1 - mean_transmittance(flat.trace(rays, Estimator::exact));
        std::printf("%s, %.2f, %.3f sr: instanced %.4f flat %.4f exact %.4f\n", placing.name,
                    opacity, solid_angle, a, b, exact);
        EXPECT_NEAR(a, b, tolerance * b) << solid_angle << " sr";
      }
    }
  }
}

}  // namespace
}  // namespace dapple
