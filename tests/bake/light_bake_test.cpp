// Baked irradiance against closed forms: at vertices, texels and instances, and inside closed
// geometry.
#include <gtest/gtest.h>

#include <cmath>

#include "dapple/bake.hpp"
#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Scene scene_of(Mesh mesh, bool double_sided = false) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].double_sided = double_sided;
  scene.meshes = {std::move(mesh)};
  scene.instances.resize(1);
  return scene;
}

Mesh plane(float side, int cells) {
  Mesh mesh;
  append_grid(mesh, {-side / 2, 0, -side / 2}, {0, 0, side}, {side, 0, 0}, cells, 0);
  return mesh;
}

/// A leaf of opacity 3/4 above the middle of the plane.
Scene leaf_above() {
  Mesh leaf = plane(2, 1);
  for (V3f& p : leaf.positions) p.y = 1;
  Scene cover = scene_of(leaf);
  cover.materials[0].alpha_mode = AlphaMode::blend;
  cover.materials[0].alpha = 0.75f;
  return cover;
}

Light noon() {
  Light sun;
  sun.name = "noon";
  sun.kind = LightKind::sun;
  sun.direction = V3f(0, -1, 0);
  sun.angular_radius = 0.01f;
  sun.radiance = V3f(10000, 5000, 0);
  return sun;
}

/// Irradiance of noon(), red, on an open horizontal plane.
const double kOpen = 10000 * kPi * std::pow(std::sin(0.01), 2);

BakeOptions lit_by(std::vector<Light> lights) {
  BakeOptions options;
  options.light = true;
  options.lights = std::move(lights);
  return options;
}

void expect_sun_through_leaf(const V3f& light, const V3f& point) {
  const float away = std::max(std::fabs(point.x), std::fabs(point.z));
  if (away < 0.4f) {
    EXPECT_NEAR(double{light.x}, 0.25 * kOpen, 0.02 * kOpen) << point;
  }
  if (away > 1.6f && away < 4) {
    EXPECT_NEAR(double{light.x}, kOpen, 0.001 * kOpen) << point;
  }
  EXPECT_NEAR(double{light.y}, 0.5 * double{light.x}, 1e-4 * kOpen) << point;
}

TEST(BakeLight, ASunAboveLightsAPlaneButNotUnderALeafAndFromOneSideOnly) {
  for (const bool double_sided : {false, true}) {
    Scene floor = scene_of(plane(8, 16), double_sided);
    for (std::size_t t = 0; t < floor.meshes[0].primitive_count() && double_sided; ++t)
      std::swap(floor.meshes[0].indices[3 * t], floor.meshes[0].indices[3 * t + 1]);  // upside down
    BakeOptions options = lit_by({noon()});
    if (double_sided) options.sides = BakeSides::max;  // a floor has its front, which is below
    const BakeResult result = bake(floor, options, {}, {leaf_above()});
    ASSERT_EQ(result.light_names, std::vector<std::string>{"noon"});
    const std::vector<V3f>& light = result.meshes.at(0).light.at(0);
    for (std::size_t v = 0; v < light.size(); ++v)
      expect_sun_through_leaf(light[v], floor.meshes[0].positions[v]);
  }
}

TEST(BakeLight, TexelsAreLitAsTheirPlacesAre) {
  const Scene floor = scene_of(plane(8, 1));
  BakeOptions options = lit_by({noon()});
  options.vertices = false;
  options.texture = true;
  options.texture_size = 64;
  options.texture_uvs.resize(1);
  for (const V3f& p : floor.meshes[0].positions)
    options.texture_uvs[0].emplace_back(p.x / 8 + 0.5f, p.z / 8 + 0.5f);
  const BakeResult result = bake(floor, options, {}, {leaf_above()});
  ASSERT_EQ(result.texture.light.size(), 1u);
  const std::vector<V3f>& light = result.texture.light[0];
  ASSERT_EQ(light.size(), 64u * 64u);
  for (std::uint32_t i = 0; i < light.size(); ++i)
    expect_sun_through_leaf(light[i], V3f(static_cast<float>(i % 64) / 8 - 4 + 1 / 16.0f, 0,
                                          static_cast<float>(i / 64) / 8 - 4 + 1 / 16.0f));
}

TEST(BakeLight, AnInstanceHasTheMeanIrradianceOfItsSamples) {
  Scene floors = scene_of(plane(0.5f, 2));
  floors.instances.resize(2);
  floors.instances[1].to_world.setTranslation(V3f(5, 0, 0));
  BakeOptions options = lit_by({noon()});
  options.vertices = false;
  options.instances = true;
  const BakeResult result = bake(floors, options, {}, {leaf_above()});
  ASSERT_EQ(result.instance_light.size(), 1u);
  EXPECT_NEAR(double{result.instance_light[0][0].x}, 0.25 * kOpen, 0.01 * kOpen);
  EXPECT_NEAR(double{result.instance_light[0][1].x}, kOpen, 0.01 * kOpen);
}

// Of a floor that is lit from above only, whichever side is its front.
TEST(BakeLight, SidesAreTheBrighterOneOrTheMean) {
  for (const bool upside_down : {false, true}) {
    Scene floor = scene_of(plane(1, 2), true);
    for (std::size_t t = 0; t < floor.meshes[0].primitive_count() && upside_down; ++t)
      std::swap(floor.meshes[0].indices[3 * t], floor.meshes[0].indices[3 * t + 1]);
    BakeOptions options = lit_by({noon()});
    options.instances = true;
    for (const auto& [sides, share] : {std::pair(BakeSides::max, 1.0), {BakeSides::mean, 0.5}}) {
      options.sides = sides;
      const BakeResult result = bake(floor, options);
      for (const V3f& light : result.meshes.at(0).light.at(0))
        EXPECT_NEAR(double{light.x}, share * kOpen, 1e-3 * kOpen) << upside_down;
      EXPECT_NEAR(double{result.instance_light.at(0).at(0).x}, share * kOpen, 1e-3 * kOpen)
          << upside_down;
    }
  }
}

TEST(BakeLight, VerticesInsideClosedGeometryHaveTheirNeighboursIrradiance) {
  // A strip of cells from far outside into a cube.
  const Scene cube = make_procedural("scene:cube?divisions=1");
  const V3f centre = scene_bounds(cube).center();
  Mesh mesh;
  append_grid(mesh, centre, {20, 0, 0}, {0, 0, -0.01f}, 40, 0);
  const BakeResult result = bake(scene_of(mesh), lit_by({noon()}), {}, {cube});
  EXPECT_GT(result.statistics.enclosed_vertices, 0u);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_GT(double{result.meshes.at(0).light.at(0)[v].x}, 0.1 * kOpen) << mesh.positions[v];
}

TEST(BakeLight, AUniformDomeLightsAsAoSaysTimesPi) {
  Light dome;
  dome.name = "sky";
  dome.kind = LightKind::dome;
  const Scene floor = scene_of(plane(4, 8));
  BakeOptions options = lit_by({dome});
  options.target_error = 0;
  options.rays = 512;
  options.light_rays = 64;
  options.estimator = Estimator::exact;
  const BakeResult result = bake(floor, options, {}, {leaf_above()});
  for (std::size_t v = 0; v < floor.meshes[0].positions.size(); ++v)
    EXPECT_NEAR(double{result.meshes[0].light[0][v].x}, kPi * double{result.meshes[0].ao[v]}, 0.05)
        << floor.meshes[0].positions[v];
}

TEST(BakeLight, ASmallerTargetErrorTakesMoreRaysAndASmallerErrorIsLeft) {
  const Scene tree = make_procedural("scene:tree?leaves=300");
  BakeOptions options = lit_by({noon()});
  double before = 1;
  std::uint64_t rays = 0;
  for (const float target : {0.1f, 0.03f}) {
    options.target_error = target;
    const BakeStatistics s = bake(tree, options).statistics;
    const double error = std::sqrt(s.squared_light_errors / static_cast<double>(s.vertices));
    EXPECT_LT(error, 1.1 * double{target});
    EXPECT_LT(error, 0.6 * before);
    EXPECT_GT(s.rays, 2 * rays);
    before = error;
    rays = s.rays;
  }
}

// At vertices, in textures and of instances: the layers of a group and of a light outside of it.
// More than 64 points of a triangle add little, so that each has more rays.
TEST(BakeLight, MoreRaysAreLessNoiseHoweverManyThereAre) {
  const Scene floor = scene_of(plane(2, 6));
  Light lamp;
  lamp.name = "lamp";
  lamp.kind = LightKind::sphere;
  lamp.position = V3f(0, 0.8f, 0);
  lamp.radius = 0.5f;
  const auto noise = [&](int rays) {
    std::vector<V3f> of_seed[2];
    for (std::uint32_t seed = 0; seed < 2; ++seed) {
      BakeOptions options = lit_by({lamp});
      options.target_error = 0;
      options.rays = rays;
      options.seed = seed;
      of_seed[seed] = bake(floor, options).meshes.at(0).light.at(0);
    }
    double squares = 0;
    for (std::size_t v = 0; v < of_seed[0].size(); ++v)
      squares += double{(of_seed[0][v] - of_seed[1][v]).length2()};
    return std::sqrt(squares);
  };
  EXPECT_LT(noise(4096), 0.7 * noise(512)) << "what is left is that of the points";
}

TEST(BakeLight, AGroupIsTheSumOfItsLights) {
  Scene floor = scene_of(plane(8, 4));
  std::vector<Light> lights = {noon(), noon(), noon()};
  lights[0].group = lights[2].group = "day";
  lights[1].name = "alone";
  lights[1].direction = V3f(0.3f, -1, 0).normalized();
  lights[2].direction = V3f(0, -1, 0.5f).normalized();
  BakeOptions options = lit_by(lights);
  options.target_error = 0;
  options.rays = 64;
  options.texture = options.instances = true;
  options.texture_size = 16;
  const BakeResult together = bake(floor, options, {}, {leaf_above()});
  ASSERT_EQ(together.light_names, (std::vector<std::string>{"day", "alone"}));
  for (Light& light : *options.lights) light.group.clear();
  const BakeResult apart = bake(floor, options, {}, {leaf_above()});
  ASSERT_EQ(apart.light_names.size(), 3u);
  const auto expect_sums = [](const std::vector<std::vector<V3f>>& sums,
                              const std::vector<std::vector<V3f>>& parts) {
    ASSERT_EQ(sums.size(), 2u);
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(sums[1], parts[1]);
    float largest = 0;
    for (std::size_t i = 0; i < parts[0].size(); ++i) {
      const V3f sum = parts[0][i] + parts[2][i];
      EXPECT_LE((sums[0][i] - sum).length(), 1e-6f * sum.length()) << i;
      largest = std::max(largest, sum.x);
    }
    EXPECT_GT(double{largest}, 1.5 * kOpen);
  };
  expect_sums(together.meshes.at(0).light, apart.meshes.at(0).light);
  expect_sums(together.texture.light, apart.texture.light);
  expect_sums(together.instance_light, apart.instance_light);
}

// The lamp's mesh has no triangle with an area, so that nothing is uploaded of it.
TEST(BakeLight, ALightThatEmitsNothingIsNotBakedAndOthersKeepTheirNames) {
  Scene scene = scene_of(plane(4, 1));
  Mesh lamp;
  lamp.positions = {V3f(0, 1, 0), V3f(1, 1, 0), V3f(2, 1, 0)};
  lamp.indices = {0, 1, 2};
  lamp.materials = {0};
  scene.meshes.push_back(lamp);
  scene.instances.emplace_back();
  scene.instances[1].mesh = 1;
  scene.instances[1].light = 0;
  Light emitting;
  emitting.name = "lamp";
  emitting.kind = LightKind::mesh;
  scene.lights = {emitting, noon()};
  BakeOptions options;
  options.light = true;
  const BakeResult result = bake(scene, options);
  EXPECT_EQ(result.light_names, std::vector<std::string>{"noon"});
  ASSERT_EQ(result.meshes.at(0).light.size(), 1u);
  for (const V3f& light : result.meshes[0].light[0]) EXPECT_NEAR(light.x, kOpen, 0.01 * kOpen);
}

TEST(BakeLight, ASceneWithoutLightsIsAnErrorAsOnTheCommandLine) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = {square_mesh(1, 0, 1, 0)};
  scene.instances.resize(1);
  BakeOptions options;
  options.light = true;
  const auto message_of = [&] {
    try {
      bake(scene, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message_of().find("the scene has no lights"), std::string::npos) << message_of();
  scene.lights = {noon()};
  EXPECT_EQ(message_of(), "");
  options.lights.emplace();  // none in place of the scene's
  EXPECT_NE(message_of().find("there are no lights"), std::string::npos) << message_of();
}

TEST(BakeLight, AMeshAloneIsNotLit) {
  BakeOptions options = lit_by({noon()});
  options.placement = BakePlacement::alone;
  EXPECT_THROW(validate(options), Error);
}

}  // namespace
}  // namespace dapple
