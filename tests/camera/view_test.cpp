// The camera matrices of an EXR file: world to a left-handed camera space that looks along +Z, and
// world to NDC with (0,0) at the top left of the display window. Also camera parameters, which
// camera and field of view the options choose, and the pixels that can see the scene.
#include "camera/view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

void expect_near(const V3f& a, const V3f& b) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], 1e-5) << a << " and " << b;
}

// A view for camera_at(), whose field of view is 90 degrees high: at distance d the picture reaches
// from -d to d vertically and, since it is twice as wide, from -2 d to 2 d horizontally.
View view_from(const Camera& camera) { return {camera, 200, 100, {0, 0, 199, 99}}; }

Camera camera_at(const V3f& eye) {
  Camera camera;
  camera.to_world.setTranslation(eye);
  camera.fov_y = static_cast<float>(std::acos(0.0));
  return camera;
}

TEST(View, CameraSpaceHasXRightYUpAndZForward) {
  const M44f straight = world_to_exr_camera(camera_at({1, 2, 3}));
  // glTF's camera looks along -Z: world +X is right, +Y up, -Z ahead.
  expect_near(V3f(1, 2, 3) * straight, {0, 0, 0});
  expect_near(V3f(1, 2, -7) * straight, {0, 0, 10});
  expect_near(V3f(2, 2, 3) * straight, {1, 0, 0});
  expect_near(V3f(1, 3, 3) * straight, {0, 1, 0});
  EXPECT_LT(straight.determinant(), 0) << "left-handed";

  // A camera at the same point that looks along +X: world +Z is right.
  const M44f turned = world_to_exr_camera(look_at({1, 2, 3}, {5, 2, 3}, {0, 1, 0}, 1));
  expect_near(V3f(8, 2, 3) * turned, {0, 0, 7});
  expect_near(V3f(1, 2, 5) * turned, {2, 0, 0});
  expect_near(V3f(1, 5, 3) * turned, {0, 3, 0});
}

void expect_ndc(const M44f& to_ndc, const V3f& world, const V2f& ndc) {
  V3f found;
  to_ndc.multVecMatrix(world, found);  // divides by w
  EXPECT_NEAR(found.x, ndc.x, 1e-5) << world;
  EXPECT_NEAR(found.y, ndc.y, 1e-5) << world;
}

TEST(View, NdcGoesFromTheTopLeftToTheBottomRightOfThePicture) {
  const M44f perspective = world_to_ndc(view_from(camera_at({1, 2, 3})));
  for (const float distance : {0.5f, 10.0f}) {
    const auto at = [&](float x, float y) {
      return V3f(1 + x * distance, 2 + y * distance, 3 - distance);
    };
    expect_ndc(perspective, at(0, 0), {0.5f, 0.5f});
    expect_ndc(perspective, at(-2, 1), {0, 0});
    expect_ndc(perspective, at(2, -1), {1, 1});
    expect_ndc(perspective, at(2, 1), {1, 0});
    expect_ndc(perspective, at(1, 0.5f), {0.75f, 0.25f});
  }

  Camera orthographic = camera_at({1, 2, 3});
  orthographic.kind = Camera::Kind::orthographic;
  orthographic.half_height = 4;
  const M44f parallel = world_to_ndc(view_from(orthographic));
  for (const float distance : {0.5f, 10.0f}) {
    expect_ndc(parallel, {1, 2, 3 - distance}, {0.5f, 0.5f});
    expect_ndc(parallel, {1 - 8, 2 + 4, 3 - distance}, {0, 0});
    expect_ndc(parallel, {1 + 8, 2 - 4, 3 - distance}, {1, 1});
  }
}

TEST(View, CameraParametersAreTheSameCameraAndCountEverySample) {
  RenderOptions options;
  options.spp = 8;
  options.seed = 5;
  View view = view_from(look_at({1, 2, 3}, {5, 2, 3}, {0, 1, 0}, 0.8f));
  view.crop = {10, 20, 59, 79};
  const CameraParams p = camera_params(view, options, Box3f(V3f(-1), V3f(1)));
  // Rows for column vectors: the last column is the eye, the third the camera's back.
  EXPECT_FLOAT_EQ(p.to_world[3], 1);
  EXPECT_FLOAT_EQ(p.to_world[7], 2);
  EXPECT_FLOAT_EQ(p.to_world[11], 3);
  EXPECT_NEAR(p.to_world[2], -1, 1e-6);
  EXPECT_FLOAT_EQ(p.half_height, std::tan(0.4f));
  EXPECT_FLOAT_EQ(p.half_width, 2 * std::tan(0.4f));
  EXPECT_EQ(p.width, 200u);
  EXPECT_EQ(p.crop_x, 10u);
  EXPECT_EQ(p.crop_y, 20u);
  EXPECT_EQ(p.crop_width, 50u);
  EXPECT_EQ(p.seed, 5u);
  EXPECT_FLOAT_EQ(p.inverse_spp, 0.125f);
}

/// Cameras a, b at another place and with a field of view of its own, and the orthographic o.
Scene scene_of_three_cameras() {
  Scene scene;
  scene.source = "three.glb";
  scene.cameras = {camera_at({1, 2, 3}), camera_at({4, 5, 6}), camera_at({7, 8, 9})};
  scene.cameras[0].name = "a";
  scene.cameras[1].name = "b";
  scene.cameras[1].fov_y = 0.5f;
  scene.cameras[2].name = "o";
  scene.cameras[2].kind = Camera::Kind::orthographic;
  scene.cameras[2].half_height = 4;
  return scene;
}

Camera chosen(const RenderOptions& options, std::vector<std::string>& notes) {
  return choose_view(scene_of_three_cameras(), options, notes).camera;
}

TEST(View, ACameraIsChosenByItsNameAndWithoutOneIsTheFirst) {
  std::vector<std::string> notes;
  for (const Camera& camera : scene_of_three_cameras().cameras) {
    RenderOptions options;
    options.camera = camera.name;
    const Camera found = chosen(options, notes);
    EXPECT_EQ(found.name, camera.name);
    EXPECT_EQ(found.to_world, camera.to_world) << camera.name;
    EXPECT_EQ(found.kind, camera.kind) << camera.name;
    EXPECT_EQ(found.fov_y, camera.fov_y) << camera.name;
    EXPECT_EQ(found.half_height, camera.half_height) << camera.name;
  }
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(chosen({}, notes).name, "a");
  EXPECT_EQ(notes, std::vector<std::string>{"camera: a, the first of 3"});
  RenderOptions options;
  options.camera = "c";
  const Error error = film_test::error_of([&] { chosen(options, notes); });
  EXPECT_EQ(error.kind(), ErrorKind::usage);
  EXPECT_STREQ(error.what(), "--camera c: three.glb has only these cameras: a, b, o");
}

TEST(View, AFieldOfViewReplacesThatOfPerspectiveCameras) {
  std::vector<std::string> notes;
  constexpr float kSixtyDegrees = std::numbers::pi_v<float> / 3;
  RenderOptions options;
  options.fov_degrees = 60;
  for (const char* name : {"a", "b"}) {
    options.camera = name;
    EXPECT_FLOAT_EQ(chosen(options, notes).fov_y, kSixtyDegrees) << name;
  }
  options.camera = "b";
  EXPECT_EQ(chosen(options, notes).to_world, scene_of_three_cameras().cameras[1].to_world);
  options.camera = "o";
  EXPECT_EQ(chosen(options, notes).kind, Camera::Kind::orthographic);
  EXPECT_EQ(chosen(options, notes).half_height, 4) << "it has no field of view";
  options.camera = "";
  options.look = LookAt{{0, 0, 5}, {0, 0, 0}};
  EXPECT_FLOAT_EQ(chosen(options, notes).fov_y, kSixtyDegrees);
  options.fov_degrees = 0;
  EXPECT_FLOAT_EQ(chosen(options, notes).fov_y, std::numbers::pi_v<float> * 2 / 9) << "40 degrees";
}

void expect_seen(const View& view, const Box3f& bounds, uint left, uint above, uint right,
                 uint below) {
  const CameraParams p = camera_params(view, {}, bounds);
  EXPECT_EQ(p.seen_left, left);
  EXPECT_EQ(p.seen_above, above);
  EXPECT_EQ(p.seen_right, right);
  EXPECT_EQ(p.seen_below, below);
}

TEST(View, TheSceneIsSeenInThePixelsOfItsBoundsAndOneAround) {
  // At distance 10 the picture is 40 m wide and 20 m high: 5 pixels a metre.
  const View view = view_from(camera_at({0, 0, 10}));
  const float nearest = -1e-3f;  // so that no corner is on a pixel's edge
  expect_seen(view, {{-2.1f, 1.1f, -50}, {3.1f, 4.1f, nearest}}, 88, 28, 117, 51);
  Camera orthographic = camera_at({0, 0, 10});
  orthographic.kind = Camera::Kind::orthographic;
  orthographic.half_height = 10;
  expect_seen(view_from(orthographic), {{-2.1f, 1.1f, -50}, {3.1f, 4.1f, 50}}, 88, 28, 117, 46);
  // Beside the picture, above it, and around the camera.
  expect_seen(view, {{100, 1.1f, -1}, {101, 2.1f, 0}}, 200, 38, 200, 47);
  expect_seen(view, {{0, 100, -1}, {1, 101, 0}}, 98, 0, 107, 0);
  expect_seen(view, {{-1, -1, 9}, {1, 1, 11}}, 0, 0, 200, 100);
}

TEST(View, ExtremeBoundsLeaveOutNoPixel) {
  const View view = view_from(camera_at({0, 0, 10}));
  expect_seen(view, {V3f(-1e30f), V3f(1e30f)}, 0, 0, 200, 100);
  expect_seen(view, {{1e6f, 0, 9.99f}, {1e6f, 1, 9.99f}}, 0, 0, 200, 100);
  expect_seen(view, {V3f(std::numeric_limits<float>::infinity()), V3f(0)}, 0, 0, 200, 100);
  View flat = view;
  flat.camera.to_world[0][0] = 0;
  expect_seen(flat, {V3f(-1), V3f(1)}, 0, 0, 200, 100);
}

}  // namespace
}  // namespace dapple
