// What reaches the other side of the surfaces that are seen: closed forms of cards and closed
// bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "dapple/render.hpp"
#include "dapple/scene.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using test::scene_of;

Light sun_from(const std::string& name, const V3f& towards) {
  Light sun;
  sun.name = name;
  sun.kind = LightKind::sun;
  sun.direction = -towards.normalized();
  sun.angular_radius = 0.02f;
  sun.radiance = V3f(1 / (std::numbers::pi_v<float> * 4e-4f));
  return sun;
}

RenderOptions picture() {
  RenderOptions options;
  options.width = options.height = 24;
  options.spp = 64;
  options.estimator = Estimator::exact;
  options.back = true;
  options.look = LookAt{V3f(0, 0, 4), V3f(0, 0, 0), V3f(0, 1, 0)};
  options.fov_degrees = 10;
  return options;
}

double mean(const Film& film, const std::string& channel) {
  const auto& pixels = film.find(channel)->pixels;
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
}

/// A square of side 2 that faces +Z, whose normals lean by `theta` towards +Y.
Scene card(double theta) {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(
      4, V3f(0, static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta))));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return scene_of(std::move(mesh));
}

TEST(Back, LightFromBehindReachesTheBackOfACard) {
  Scene scene = card(0);
  scene.lights = {sun_from("behind", {0, 1, -1}), sun_from("before", {0, 0, 1})};
  const Film film = render(scene, picture()).film;
  EXPECT_EQ(mean(film, "light.behind.R"), 0);
  EXPECT_NEAR(mean(film, "light.behind.back.R"), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(mean(film, "light.before.R"), 1, 1e-3);
  EXPECT_EQ(mean(film, "light.before.back.R"), 0);
  EXPECT_NEAR(mean(film, "ao.R"), 1, 1e-6);
  EXPECT_NEAR(mean(film, "ao.back.R"), 1, 1e-6);
}

TEST(Back, ALeaningNormalLeansTheOtherWayBehind) {
  const double theta = std::numbers::pi / 3;
  Scene scene = card(theta);
  scene.lights = {sun_from("behind", {0, 0, -1})};
  const Film film = render(scene, picture()).film;
  EXPECT_NEAR(mean(film, "ao.back.R"), (1 + std::cos(theta)) / 2, 0.003);
  EXPECT_NEAR(mean(film, "light.behind.back.R"), std::cos(theta), 2e-3);
}

TEST(Back, AnOpaqueSheetBehindShadowsTheBackAlone) {
  Scene scene = card(0);
  Mesh wall = scene.meshes[0];
  for (V3f& p : wall.positions) p = V3f(p.x * 1000, p.y * 1000, -1e-2f);
  scene.meshes.push_back(wall);
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  const Film film = render(scene, picture()).film;
  EXPECT_NEAR(mean(film, "ao.R"), 1, 1e-6);
  EXPECT_LE(mean(film, "ao.back.R"), 1e-3);
}

TEST(Back, ClosedBodiesAreDarkInside) {
  Scene scene = scene_of(test::smooth_sphere());
  scene.lights = {sun_from("sun", {0, 1, 1})};
  const Film film = render(scene, picture()).film;
  EXPECT_GT(mean(film, "ao.R"), 0.99);
  EXPECT_LE(mean(film, "ao.back.R"), 0.001);
  EXPECT_LE(mean(film, "light.sun.back.R"), 0.001);
}

TEST(Back, ChangesNoOtherLayerAndIsThereOnlyIfAsked) {
  Scene scene = card(0.5);
  RenderOptions options = picture();
  const Film with = render(scene, options).film;
  options.back = false;
  const Film without = render(scene, options).film;
  EXPECT_EQ(without.find("ao.back.R"), nullptr);
  for (const Plane& plane : without.planes) {
    if (plane.channel.starts_with("visits")) continue;
    EXPECT_EQ(plane.pixels, with.find(plane.channel)->pixels) << plane.channel;
  }
}

// Rays that miss count as in the layers of the front: 1 of AO, 0 of lights.
TEST(Back, MissesCountAsInTheLayersOfTheFront) {
  Scene scene = card(0);
  scene.lights = {sun_from("behind", {0, 0, -1})};
  RenderOptions options = picture();
  options.look = LookAt{V3f(0, 5, 4), V3f(0, 5, 0), V3f(0, 1, 0)};
  const Film film = render(scene, options).film;
  EXPECT_EQ(mean(film, "A"), 0);
  EXPECT_EQ(mean(film, "ao.back.R"), 1);
  EXPECT_EQ(mean(film, "light.behind.back.R"), 0);
}

/// Leaves that let light through, under a sun.
Scene thin_leaves() {
  Scene scene = make_procedural("scene:cloud?leaves=2000&opacity=0.3");
  scene.lights = {sun_from("sun", {1, 2, -1})};
  return scene;
}

RenderOptions leaf_picture(int splitting, int back_every) {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 32;
  options.camera_splitting = splitting;
  options.back = true;
  options.back_every = back_every;
  options.report_bias = 0;
  return options;
}

// Samples that share a camera ray lie on surfaces one behind the other: each must have its turn.
TEST(Back, OneSampleInFourEightOrSixteenHasTheMeansOfAllSamples) {
  const Scene scene = thin_leaves();
  for (const int splitting : {1, 4}) {
    const Film all = render(scene, leaf_picture(splitting, 1)).film;
    for (const int every : {4, 8, 16}) {
      const Film few = render(scene, leaf_picture(splitting, every)).film;
      const double limit = every == 16 ? 0.11 : 0.08;
      // Standard deviations of the ratios are at most 0.03, and 0.04 of sixteen.
      EXPECT_NEAR((1 - mean(few, "ao.back.R")) / (1 - mean(all, "ao.back.R")), 1, limit);
      EXPECT_NEAR(mean(few, "light.sun.back.R") / mean(all, "light.sun.back.R"), 1, limit);
      EXPECT_NE(all.find("ao.back.R")->pixels, few.find("ao.back.R")->pixels);
      EXPECT_EQ(all.find("ao.R")->pixels, few.find("ao.R")->pixels);
    }
  }
}

TEST(Back, EveryPixelHasASampleHoweverFewThereAre) {
  Scene scene = card(0);
  scene.lights = {sun_from("behind", {0, 0, -1})};
  for (const int spp : {1, 2, 5, 16}) {
    RenderOptions options = picture();
    options.spp = spp;
    const Film film = render(scene, options).film;
    for (const float value : film.find("light.behind.back.R")->pixels) EXPECT_NEAR(value, 1, 0.01);
  }
}

TEST(Back, ACropHasTheValuesOfTheWholePicture) {
  const Scene scene = thin_leaves();
  RenderOptions options = leaf_picture(2, 8);
  const Film whole = render(scene, options).film;
  options.crop = PixelRect{20, 11, 43, 50};
  const Film part = render(scene, options).film;
  const std::vector<float>& of_whole = whole.find("ao.back.R")->pixels;
  const std::vector<float>& of_part = part.find("ao.back.R")->pixels;
  for (int y = 11; y <= 50; ++y)
    for (int x = 20; x <= 43; ++x)
      ASSERT_EQ(of_whole[static_cast<std::size_t>(y * 64 + x)],
                of_part[static_cast<std::size_t>((y - 11) * 24 + x - 20)])
          << x << ", " << y;
}

// Quiet pixels, such as sky, get fewer samples than the footprints are made for.
TEST(Back, WithATargetSkyHasNoBacksOfLeavesBesideIt) {
  Mesh mesh;
  mesh.positions = {{-0.2f, -0.2f, 0}, {0.2f, -0.2f, 0}, {0.2f, 0.2f, 0}, {-0.2f, 0.2f, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  const Scene scene = scene_of(std::move(mesh));
  RenderOptions options = picture();
  options.light = false;
  options.ground = true;
  options.back_every = 64;
  options.spp = 1;
  options.max_spp = 256;
  for (float RenderOptions::*target : {&RenderOptions::target_error, &RenderOptions::target_rmse}) {
    RenderOptions with_target = options;
    with_target.*target = 0.01f;
    const Film film = render(scene, with_target).film;
    const auto& settings = film.metadata.settings;
    const std::pair<std::string, std::string> used("back_every", "8");
    EXPECT_EQ(std::count(settings.begin(), settings.end(), used), 1) << "not the 64 of the options";
    std::size_t sky = 0;
    for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
      if (film.find("A")->pixels[p] > 0) continue;
      ++sky;
      EXPECT_EQ(film.find("ao.back.R")->pixels[p], 1) << p;
    }
    EXPECT_GT(sky, 10u);
  }
}

/// What all rays of a picture cost: node visits and triangle tests.
std::pair<double, double> costs(const RenderStatistics& s) {
  const auto camera = static_cast<double>(s.rays.camera), ao = static_cast<double>(s.rays.ao),
             light = static_cast<double>(s.rays.light);
  return {camera * s.camera.visits + ao * s.ao.visits + light * s.light.visits,
          camera * s.camera.tests + ao * s.ao.tests + light * s.light.tests};
}

Light dome() {
  Light sky;
  sky.name = "sky";
  sky.kind = LightKind::dome;
  return sky;
}

// A ball of leaves costs as much from behind as from before.
TEST(Back, RaysOfBacksCountInTheStatisticsAndInTheLayersOfVisits) {
  Scene scene = thin_leaves();
  scene.lights.push_back(dome());
  RenderOptions options = leaf_picture(1, 1);
  options.width = options.height = 32;
  options.spp = 8;
  options.visits = true;
  for (const Packets packets : {Packets::automatic, Packets::scalar}) {
    options.packets = packets;
    options.back = true;
    const RenderResult with = render(scene, options);
    options.back = false;
    const RenderResult without = render(scene, options);
    const RenderStatistics &both = with.statistics, &front = without.statistics;
    EXPECT_EQ(both.rays.camera, front.rays.camera);
    EXPECT_EQ(both.rays.ao, 2 * front.rays.ao);
    EXPECT_EQ(both.rays.light, 2 * front.rays.light);
    EXPECT_NEAR(both.ao.visits / front.ao.visits, 1, 0.5);
    EXPECT_NEAR(both.light.visits / front.light.visits, 1, 0.5);
    const auto pixels_rays = static_cast<double>(both.rays.camera);  // as many for each pixel
    for (const RenderResult* result : {&with, &without}) {
      const auto [visits, tests] = costs(result->statistics);
      EXPECT_NEAR(mean(result->film, "visits.nodes") * pixels_rays / visits, 1, 1e-4);
      EXPECT_NEAR(mean(result->film, "visits.triangles") * pixels_rays / tests, 1, 1e-4);
    }
    EXPECT_GT(mean(with.film, "visits.nodes"), 1.1 * mean(without.film, "visits.nodes"));
  }
}

TEST(Back, OneSampleInSixteenHasASixteenthOfTheRays) {
  const Scene scene = card(0);
  RenderOptions options = picture();
  options.light = false;
  options.back = false;
  const std::uint64_t front = render(scene, options).statistics.rays.ao;
  options.back = true;
  options.back_every = 16;
  EXPECT_EQ(render(scene, options).statistics.rays.ao, front + front / 16);
}

}  // namespace
}  // namespace dapple
