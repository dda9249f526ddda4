// Scenes in which something is scaled to nothing, or dark, at some moments: objects and lights that
// appear or vanish while the shutter is open, or in the next frame, and lights of which nothing is
// left.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

RenderOptions small_picture() {
  RenderOptions options;
  options.width = options.height = 32;
  options.spp = 64;
  return options;
}

double mean(const Film& film, const std::string& channel) {
  const auto& pixels = film.find(channel)->pixels;
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
}

/// A matrix that scales everything to nothing, as animations do to hide a node.
M44f nothing() {
  M44f matrix;
  matrix.setScale(V3f(0));
  return matrix;
}

/// A smooth sphere of radius 1, seen by a parallel camera.
Scene sphere() {
  Scene scene = test::scene_of(test::smooth_sphere(8, 5));
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 1.2f;
  camera.to_world.setTranslation(V3f(0, 0, 3));
  scene.cameras.push_back(camera);
  return scene;
}

/// The sphere behind a strand; without the sphere only the strand is left.
Scene sphere_and_strand(bool has_sphere) {
  Scene scene = sphere();
  if (!has_sphere) scene.instances[0].to_world = nothing();
  Mesh strand;
  strand.positions = {{-1, -1.1f, 1.5f}, {1, -1.1f, 1.5f}};
  strand.indices = {0, 1};
  strand.materials = {0};
  strand.radii = {0.05f, 0.05f};
  place(scene, std::move(strand));
  return scene;
}

/// A sphere that an animation has scaled to nothing, or not.
Scene moving_sphere(bool is_there) {
  Scene scene = sphere();
  scene.animations.emplace_back();
  if (!is_there) scene.instances[0].to_world = nothing();
  return scene;
}

TEST(VisibilityChanges, AFrameInWhichNothingIsLeftIsEmpty) {
  RenderOptions options = small_picture();
  options.motion = true;
  const auto next = [](int) { return moving_sphere(true); };
  const RenderResult empty =
      Renderer().render_shutter([](int) { return moving_sphere(false); }, 1, options, {}, next);
  for (const float a : empty.film.find("A")->pixels) EXPECT_EQ(a, 0);
  const auto& notes = empty.statistics.notes;
  EXPECT_NE(std::find(notes.begin(), notes.end(), "nothing is left in this frame"), notes.end());
  Scene rest = moving_sphere(false);  // of points and bakes, which have no frames
  EXPECT_THROW(merge_single_instances(rest), Error);
  Scene still = moving_sphere(false);
  still.animations.clear();
  EXPECT_THROW(render(std::move(still), small_picture()), Error);
}

TEST(VisibilityChanges, AMomentInWhichNothingIsLeftAddsNothing) {
  RenderOptions options = small_picture();
  const auto scene_at = [](int k) { return moving_sphere(k == 1); };
  const Film half = Renderer().render_shutter(scene_at, 2, options).film;
  EXPECT_NEAR(mean(half, "A"), 0.5 * mean(render(moving_sphere(true), options).film, "A"), 0.01);
}

TEST(VisibilityChanges, ASmoothMeshMayAppearWhereThereWereOnlyStrands) {
  RenderOptions options = small_picture();
  options.light = false;
  for (const bool sphere_first : {false, true}) {
    const auto scene_at = [&](int k) { return sphere_and_strand((k == 0) == sphere_first); };
    const Film film = Renderer().render_shutter(scene_at, 2, options).film;
    const Film with = render(sphere_and_strand(true), options).film;
    const Film without = render(sphere_and_strand(false), options).film;
    for (const char* channel : {"A", "ao.R"}) {
      // Half of the samples of each picture.
      EXPECT_NEAR(mean(film, channel), 0.5 * (mean(with, channel) + mean(without, channel)), 0.01)
          << channel;
    }
    // Of the samples that hit, nearly all are of the sphere.
    const std::size_t middle = 16 * 32 + 16;
    EXPECT_NEAR(film.find("A")->pixels[middle], 0.5, 0.02);
    // These are means over what was hit.
    for (const char* channel : {"N.Z", "Ng.Z", "albedo.G"})
      EXPECT_NEAR(film.find(channel)->pixels[middle], with.find(channel)->pixels[middle], 0.02);
  }
}

TEST(VisibilityChanges, ALightThatIsDarkAtSomeMomentsCountsForTheOthers) {
  RenderOptions options = small_picture();
  options.ao = false;
  const auto lit = [](bool on) {
    Scene scene = sphere();
    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::sun;
    sun.direction = on ? V3f(-1, -1, -1).normalized() : V3f(0, 0, -1);
    sun.angular_radius = 0.02f;
    sun.radiance = V3f(on ? 1000.0f : 0.0f);
    scene.lights = {sun};
    return scene;
  };
  const double always = mean(render(lit(true), options).film, "light.sun.R");
  ASSERT_GT(always, 0.1);
  for (const int lit_moment : {0, 1, 2, 3}) {
    const auto scene_at = [&](int k) { return lit(k == lit_moment); };
    const Film film = Renderer().render_shutter(scene_at, 4, options).film;
    EXPECT_NEAR(mean(film, "light.sun.R"), always / 4, 0.02 * always) << lit_moment;
  }
  EXPECT_EQ(mean(render(lit(false), options).film, "light.sun.R"), 0);
}

// The first scene's lights are as the tracer has them: the sky's image is divided by its mean.
TEST(VisibilityChanges, ASkyIsAsBrightThroughAShutterAsInAStill) {
  RenderOptions options = small_picture();
  options.ao = false;
  Scene scene = sphere();
  scene.lights = daylight(scene.cameras[0]);
  const Film still = render(scene, options).film;
  const Film film = Renderer().render_shutter([&](int) { return scene; }, 2, options).film;
  for (const char* channel : {"light.sky.R", "light.sky.B", "light.sun.G"}) {
    ASSERT_GT(mean(still, channel), 0);
    EXPECT_NEAR(mean(film, channel), mean(still, channel), 1e-6 * mean(still, channel));
  }
}

// The pilot, which pictures of 2^20 samples have, looks at the rays of each light.
TEST(VisibilityChanges, ASceneWhoseOnlyLightIsScaledToNothingGetsDaylight) {
  Scene scene = sphere();
  Light glow;
  glow.name = "glow";
  glow.kind = LightKind::mesh;
  glow.radiance = V3f(1);
  scene.lights = {glow};
  Instance hidden = scene.instances[0];
  hidden.light = 0;
  hidden.to_world = nothing();
  scene.instances.push_back(hidden);
  RenderOptions options;
  options.width = options.height = 256;
  options.ao = false;
  const RenderResult result = render(std::move(scene), options);
  EXPECT_GT(mean(result.film, "light.sun.R"), 0);
  EXPECT_EQ(result.film.find("light.glow.R"), nullptr);
}

/// A square of more triangles than small meshes have, placed as "moving" and as "other".
Scene squares(float shift, bool has_other) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  scene.animations.push_back({"a", 1});
  Mesh mesh;
  append_grid(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 16, 0);
  place(scene, std::move(mesh));
  scene.node_names = {"moving", "other"};
  Instance other = scene.instances[0];
  scene.instances[0].node = 0;
  scene.instances[0].to_world.setTranslation(V3f(shift, 0, -4));
  other.node = 1;
  other.to_world.setTranslation(V3f(0, 50, -4));
  if (!has_other) other.to_world = nothing();
  scene.instances.push_back(other);
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 0.5f;
  scene.cameras.push_back(camera);
  return scene;
}

Film with_motion(const Scene& now, const Scene& next) {
  RenderOptions options = small_picture();
  options.ao = options.light = false;
  options.motion = true;
  return Renderer()
      .render_shutter([&](int) { return now; }, 1, options, {}, [&](int) { return next; })
      .film;
}

TEST(VisibilityChanges, AnObjectMovesWhereAnotherCopyOfItsMeshAppearsOrVanishes) {
  for (const bool now : {false, true}) {
    for (const bool next : {false, true}) {
      const Film film = with_motion(squares(0, now), squares(0.1f, next));
      // 32 pixels are a metre; the square fills the picture.
      EXPECT_NEAR(mean(film, "motion.X"), 3.2, 0.01) << now << next;
    }
  }
}

TEST(VisibilityChanges, NothingMovesTowardsAFrameThatShowsNothing) {
  Scene next = squares(0.1f, false);
  next.instances[0].to_world = nothing();
  const Film film = with_motion(squares(0, true), next);
  EXPECT_EQ(mean(film, "A"), 1);
  EXPECT_EQ(mean(film, "motion.X"), 0);
}

TEST(VisibilityChanges, ABvhThatCouldNotBeUpdatedIsBuiltAnewByTheNextUpdate) {
  const Scene first = squares(0, true);
  Scene nothing_left = first, moved = first;
  for (V3f& position : nothing_left.meshes[0].positions) position.x = 0;
  nothing_left.instances.clear();
  UpdatableBvh bvh(first);
  EXPECT_THROW(bvh.update(nothing_left), Error);
  const BvhUpdate again = bvh.update(first);
  EXPECT_TRUE(again.is_new);
  EXPECT_EQ(bvh.bvh().bounds.size(), build_bvh(first).bounds.size());
}

}  // namespace
}  // namespace dapple
