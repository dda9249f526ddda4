// Motion vectors of squares and cameras that move, compared with their projections worked out by
// hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kWidth = 48, kHeight = 32;
constexpr float kDepth = 4;    // of the square, metres
constexpr float kHalf = 0.5f;  // half height of the picture at distance 1
constexpr double kPixels = kHeight / 2.0 / kHalf / kDepth;  // of a metre at that depth

struct Pose {
  V3f square{0, 0, 0}, camera{0, 0, 0};
  float size = 1;  ///< the vertices' scale about the middle of the square
  float roll = 0;  ///< of the camera, radians
};

Scene scene_of(const Pose& pose) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh mesh;
  const float s = pose.size;
  append_grid(mesh, {-s, -s, 0}, {2 * s, 0, 0}, {0, 2 * s, 0}, 3, 0);
  add_triangles_out_of_sight(mesh);
  place(scene, std::move(mesh));
  Instance behind = scene.instances[0];  // a second one, so that the mesh is not merged
  scene.instances[0].to_world.setTranslation(V3f(0, 0, -kDepth) + pose.square);
  behind.to_world.setTranslation(V3f(0, 0, 100));
  scene.instances.push_back(behind);
  Camera camera;
  camera.fov_y = 2 * std::atan(kHalf);
  camera.to_world.rotate(V3f(0, 0, pose.roll));
  camera.to_world[3][0] = pose.camera.x;
  camera.to_world[3][1] = pose.camera.y;
  camera.to_world[3][2] = pose.camera.z;
  scene.cameras.push_back(camera);
  return scene;
}

RenderOptions with_motion() {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = 32;
  options.ao = options.light = false;
  options.motion = true;
  return options;
}

Film picture(const Pose& now, const Pose& next) {
  return Renderer()
      .render_shutter([&](int) { return scene_of(now); }, 1, with_motion(), {},
                      [&](int) { return scene_of(next); })
      .film;
}

using Expected = std::function<Imath::V2d(double x, double y)>;

// `expected`: of a point of the square, metres from its middle, x right and y up.
void expect_motion(const Film& film, const Expected& expected) {
  const auto plane = [&](const char* name) { return film.find(name)->pixels; };
  const auto x = plane("motion.X"), y = plane("motion.Y"), alpha = plane("A");
  int covered = 0;
  for (int p = 0; p < kWidth * kHeight; ++p) {
    if (alpha[p] == 0) {
      EXPECT_EQ(x[p], 0);
      EXPECT_EQ(y[p], 0);
    }
    if (alpha[p] < 1) continue;
    ++covered;
    // Motions are linear over the pixel: the mean of its stratified samples is that of its middle
    // to an eighth of the pixel's own variation.
    const auto seen = expected((p % kWidth + 0.5 - kWidth / 2) / kPixels,
                               (kHeight / 2 - p / kWidth - 0.5) / kPixels);
    EXPECT_NEAR(x[p], seen.x, 0.01) << p;
    EXPECT_NEAR(y[p], seen.y, 0.01) << p;
  }
  EXPECT_GT(covered, 100);
}

TEST(Motion, AMovingSquareMovesByItsProjectionEverywhere) {
  expect_motion(picture({}, {.square = {0.3f, -0.2f, 0}}),
                [](double, double) { return Imath::V2d(0.3, -0.2) * kPixels; });
}

TEST(Motion, AMovingCameraMovesStillSurfacesTheOtherWay) {
  expect_motion(picture({}, {.camera = {0.3f, -0.2f, 0}}),
                [](double, double) { return Imath::V2d(-0.3, 0.2) * kPixels; });
}

TEST(Motion, AnApproachingCameraMakesPointsMoveFromTheMiddle) {
  // From depth 4 to depth 3.9: farther from the middle by a part of 4 / 3.9 - 1.
  expect_motion(picture({}, {.camera = {0, 0, -0.1f}}),
                [](double x, double y) { return Imath::V2d(x, y) * kPixels * (kDepth / 3.9 - 1); });
}

TEST(Motion, ARollingCameraTurnsTheImage) {
  constexpr double kRoll = 0.05;
  expect_motion(picture({}, {.roll = static_cast<float>(kRoll)}), [](double x, double y) {
    const double c = std::cos(kRoll), s = std::sin(kRoll);
    return Imath::V2d(x * c + y * s - x, y * c - x * s - y) * kPixels;
  });
}

TEST(Motion, DeformedMeshesMoveByTheirVertices) {
  expect_motion(picture({}, {.size = 1.1f}),
                [](double x, double y) { return Imath::V2d(x, y) * kPixels * 0.1; });
}

TEST(Motion, WhatStandsStillHasNone) {
  const Film film = picture({}, {});
  for (const char* name : {"motion.X", "motion.Y"})
    for (const float value : film.find(name)->pixels) EXPECT_EQ(value, 0);
}

TEST(Motion, PointsBehindTheNextCameraHaveNone) {
  const Film film = picture({}, {.camera = {0, 0, -10}});
  for (const float value : film.find("motion.X")->pixels) EXPECT_EQ(value, 0);
}

TEST(Motion, AShutterAddsUpTheMotionsOfItsMoments) {
  const auto at = [](int k) { return scene_of({.square = {0.1f * static_cast<float>(k), 0, 0}}); };
  const auto next = [](int k) {
    return scene_of({.square = {0.1f * static_cast<float>(k) + 0.2f, 0, 0}});
  };
  const Film film = Renderer().render_shutter(at, 2, with_motion(), {}, next).film;
  expect_motion(film, [](double, double) { return Imath::V2d(0.2, 0) * kPixels; });
}

void expect_refused(const std::function<RenderResult()>& render_it, ErrorKind kind) {
  try {
    render_it();
    ADD_FAILURE() << "was not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
  }
}

TEST(Motion, WithoutANextFrameItIsRefused) {
  expect_refused([] { return render(scene_of({}), with_motion()); }, ErrorKind::usage);
}

Film picture_of(const Scene& now, const Scene& next) {
  return Renderer()
      .render_shutter([&](int) { return now; }, 1, with_motion(), {}, [&](int) { return next; })
      .film;
}

void expect_stillness(const Film& film) {
  expect_motion(film, [](double, double) { return Imath::V2d(0, 0); });
}

// Two placements of equal meshes, of which one is seen at a time: none of them moves.
TEST(Motion, ObjectsThatSwapAreToldApartByName) {
  const auto scene_with = [](int node) {
    Scene scene = scene_of({});
    scene.node_names = {"left", "right", "behind"};
    scene.instances[0].node = node;
    scene.instances[0].to_world[3][0] = 0.1f * static_cast<float>(node);
    scene.instances[1].node = 2;
    return scene;
  };
  expect_stillness(picture_of(scene_with(0), scene_with(1)));
  const Scene now = scene_with(0);
  Scene merged = now;  // has no second placement, and so another kind of mesh
  merged.instances.pop_back();
  expect_stillness(picture_of(now, merged));
}

/// The square, and another object behind the camera, both placed once: they become one mesh.
Scene two_objects(const V3f& at, float size, bool square_last) {
  Scene scene = scene_of({.square = at, .size = size});
  Scene other = scene_of({});
  scene.instances.pop_back();
  scene.instances[0].node = 0;
  scene.node_names = {"square", "other"};
  other.instances[1].node = 1;
  other.instances[1].mesh = 1;
  scene.instances.push_back(other.instances[1]);
  scene.meshes.push_back(other.meshes[0]);
  if (square_last) std::swap(scene.instances[0], scene.instances[1]);
  return scene;
}

TEST(Motion, WhatStaysMovesThoughOthersComeOrGo) {
  for (const bool square_last : {false, true}) {
    const Scene both = two_objects({0, 0, 0}, 1, square_last);
    const auto moved = [&](bool with_other) {
      Scene scene = two_objects({0.3f, -0.2f, 0}, 1, square_last);
      if (!with_other) scene.instances.erase(scene.instances.begin() + (square_last ? 0 : 1));
      return scene;
    };
    for (const bool with_other : {true, false}) {
      expect_motion(picture_of(both, moved(with_other)),
                    [](double, double) { return Imath::V2d(0.3, -0.2) * kPixels; });
      expect_motion(picture_of(moved(with_other), both),
                    [](double, double) { return Imath::V2d(-0.3, 0.2) * kPixels; });
    }
  }
}

// Leaves of one name before and after a stem: without it they follow each other in the merged mesh.
TEST(Motion, ObjectsOfOneNameMoveThoughWhatIsBetweenThemGoes) {
  const auto leaves = [](const V3f& at, bool with_stem) {
    Scene scene = scene_of({.square = at});
    scene.node_names = {"leaf", "stem", "leaf"};
    const Instance square = scene.instances[0], behind = scene.instances[1];
    scene.instances.clear();
    scene.meshes.resize(1, scene.meshes[0]);
    for (int node = 0; node < 3; ++node) {
      if (node == 1 && !with_stem) continue;
      Instance instance = node == 0 ? square : behind;
      instance.node = node;
      instance.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
      scene.instances.push_back(instance);
      scene.meshes.push_back(scene.meshes[0]);
    }
    scene.meshes.pop_back();
    return scene;
  };
  for (const bool now : {false, true})
    for (const bool then : {false, true})
      expect_motion(picture_of(leaves({0, 0, 0}, now), leaves({0.3f, -0.2f, 0}, then)),
                    [](double, double) { return Imath::V2d(0.3, -0.2) * kPixels; });
}

// The placement that goes or comes is the first, which names objects that are placed once.
TEST(Motion, PlacementsMoveThoughOthersOfTheirMeshComeOrGo) {
  const auto scene_with = [](const V3f& at, bool with_others) {
    Scene scene = scene_of({.square = at});
    scene.node_names = {"square", "first", "last"};
    const Instance square = scene.instances[0];
    Instance other = scene.instances[1];
    scene.instances.clear();
    for (const int node : {1, 0, 2}) {
      scene.instances.push_back(node == 0 ? square : other);
      scene.instances.back().node = node;
      if (node == 1 && !with_others) scene.instances.pop_back();
    }
    return scene;
  };
  for (const bool now : {false, true})
    expect_motion(picture_of(scene_with({0, 0, 0}, now), scene_with({0.3f, -0.2f, 0}, !now)),
                  [](double, double) { return Imath::V2d(0.3, -0.2) * kPixels; });
}

TEST(Motion, AnObjectWithOtherTrianglesStandsStill) {
  Scene next = two_objects({0.3f, 0, 0}, 1, false);
  std::swap(next.meshes[0].indices[0], next.meshes[0].indices[1]);
  expect_stillness(picture_of(two_objects({0, 0, 0}, 1, false), next));
}

}  // namespace
}  // namespace dapple
