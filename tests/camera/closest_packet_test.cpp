// Closest-hit packets: camera rays that intersect boxes together find what single rays find. Single
// rays are used in instances, so the same tree is rendered in the world and as an instance.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Camera camera_at(const V3f& from, const V3f& at, Camera::Kind kind) {
  Camera camera = look_at(from, at, {0, 1, 0}, 0.7f);
  camera.kind = kind;
  camera.half_height = 4;
  return camera;
}

/// Adds a second instance behind the camera, so that the tree is not merged into the world.
Scene with_another_far_away(Scene scene) {
  for (std::size_t i = 0, count = scene.instances.size(); i < count; ++i) {
    scene.instances.push_back(scene.instances[i]);
    scene.instances.back().to_world[3][2] += 1000;
  }
  return scene;
}

std::vector<float> channel(const RenderResult& picture, const char* name) {
  return picture.film.find(name)->pixels;
}

/// Two samples may differ: near edges, on devices that round rays in instances differently. On PoCL
/// none does.
void expect_alike(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  std::size_t different = 0;
  for (std::size_t p = 0; p < a.size(); ++p) different += std::fabs(a[p] - b[p]) > 1e-4f ? 1 : 0;
  EXPECT_LE(different, 2u);
}

TEST(ClosestPacketOnDevice, FindsTheSameHitsAsInAnInstance) {
  RenderOptions options;
  options.width = options.height = 96;
  options.spp = 8;
  options.light = false;
  options.ao_rays = 1;
  options.estimator = Estimator::exact;
  Scene scene = load_scene("scene:tree?leaves=3000&opacity=0.6");
  const V3f middle = scene_bounds(scene).center();
  for (const Camera::Kind kind : {Camera::Kind::perspective, Camera::Kind::orthographic}) {
    // Along an axis, so that ray directions have both signs on two axes, and obliquely, so that
    // they have one sign on each axis.
    for (const V3f& way : {V3f(0, 0, 9), V3f(-6, 5, 7)}) {
      scene.cameras = {camera_at(middle + way, middle, kind)};
      const RenderResult one = render(scene, options);
      const RenderResult placed = render(with_another_far_away(scene), options);
      ASSERT_LT(one.statistics.camera.visits, placed.statistics.camera.visits) << "the same way";
      for (const char* name : {"A", "N.X", "N.Y"})
        expect_alike(channel(one, name), channel(placed, name));
    }
  }
}

}  // namespace
}  // namespace dapple
