// Previews of baked scenes: grey levels are the AO as sRGB, the nearer surface is visible, and
// transparent surfaces are not drawn.
#include "bake/preview.hpp"

#include <gtest/gtest.h>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Camera from_above() {
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 1;
  camera.to_world.rotate(V3f(static_cast<float>(-kPi / 2), 0, 0));
  camera.to_world = camera.to_world * M44f().setTranslation(V3f(0, 5, 0));
  return camera;
}

Scene two_squares() {
  Scene scene;
  scene.materials.resize(2);
  for (std::uint32_t m = 0; m < 2; ++m) {
    Mesh mesh;
    const float side = m == 0 ? 4.0f : 0.5f, height = static_cast<float>(m);
    append_grid(mesh, {-side / 2, height, -side / 2}, {0, 0, side}, {side, 0, 0}, 1, m);
    scene.meshes.push_back(mesh);
    scene.instances.push_back({});
    scene.instances.back().mesh = m;
  }
  return scene;
}

BakeResult with_ao(const Scene& scene, float first, float second) {
  BakeResult result;
  for (const float ao : {first, second}) {
    result.meshes.emplace_back();
    result.meshes.back().ao.assign(scene.meshes[0].positions.size(), ao);
  }
  return result;
}

TEST(BakePreview, TheNearerSurfaceShowsItsAoAsSrgb) {
  const Scene scene = two_squares();
  const ByteImage image = draw_preview(scene, with_ao(scene, 1, 0.2159f), from_above(), 64, 64);
  ASSERT_EQ(image.bytes.size(), 64u * 64u);
  EXPECT_EQ(image.bytes[0], 255);
  EXPECT_EQ(image.bytes[32 * 64 + 32], 128) << "sRGB of 0.2159";
}

TEST(BakePreview, ATransparentSurfaceIsNotDrawn) {
  Scene scene = two_squares();
  scene.materials[1].alpha_mode = AlphaMode::mask;
  scene.materials[1].alpha = 0.2f;
  const ByteImage image = draw_preview(scene, with_ao(scene, 1, 0), from_above(), 64, 64);
  EXPECT_EQ(image.bytes[32 * 64 + 32], 255);
}

TEST(BakePreview, AGroundUnderTheCameraIsDrawnInFrontOfIt) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = {square_mesh(100, 0, 1, 0)};  // two triangles, also behind the camera
  scene.instances.resize(1);
  BakeResult result;
  result.meshes.resize(1);
  for (const V3f& p : scene.meshes[0].positions) result.meshes[0].ao.push_back(p.x < 0 ? 0 : 1);
  Camera camera;
  camera.to_world.setTranslation(V3f(0, 1, 0));
  const ByteImage image = draw_preview(scene, result, camera, 64, 64);
  EXPECT_EQ(image.bytes[0], image.bytes[63]) << "above the horizon";
  // AO rises along X, from 0 to 1 over 100 m: near the camera it is a half, sRGB 188.
  for (int x = 0; x < 64; ++x) EXPECT_NEAR(image.bytes[63 * 64 + x], 188, 3) << x;
  const int far_left = image.bytes[34 * 64], far_right = image.bytes[34 * 64 + 63];
  EXPECT_LT(far_left + 10, far_right);
}

TEST(BakePreview, InstancesShowTheirOwnValue) {
  const Scene scene = two_squares();
  BakeResult result;
  result.instance_ao = {1, 0};
  const ByteImage image = draw_preview(scene, result, from_above(), 64, 64);
  EXPECT_EQ(image.bytes[0], 255);
  EXPECT_EQ(image.bytes[32 * 64 + 32], 0);
}

}  // namespace
}  // namespace dapple
