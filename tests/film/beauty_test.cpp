// RGBA recombined from its layers, and the sky that it has where the scene brings none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "dapple/render.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

float at(const Film& film, const std::string& channel, std::size_t pixel) {
  return film.find(channel)->pixels[pixel];
}

double ambient_of(const Film& film) {
  for (const auto& [name, value] : film.metadata.settings)
    if (name == "ambient") return std::stod(value);
  return -1;
}

/// The largest difference of RGB from `value` of a pixel and a letter, relative to the largest RGB.
template <class Value>
double worst_difference(const Film& film, const Value& value) {
  double worst = 0, largest = 0;
  for (const char* letter : {"R", "G", "B"}) {
    for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
      largest = std::max<double>(largest, at(film, letter, p));
      worst = std::max(worst, std::fabs(value(p, std::string(".") + letter) - at(film, letter, p)));
    }
  }
  EXPECT_GT(largest, 0);
  return worst / largest;
}

/// RGB against the sum of what the sky and each light give it.
double worst_sum(const Film& film, const std::vector<std::string>& lights) {
  return worst_difference(film, [&](std::size_t p, const std::string& letter) {
    double sum = at(film, "beauty.ambient" + letter, p);
    for (const std::string& name : lights) sum += at(film, "beauty." + name + letter, p);
    return sum;
  });
}

/// RGB against the product of the pixel's means, which it is where all samples have one albedo.
double worst_product(const Film& film, const std::vector<std::string>& lights) {
  const double ambient = ambient_of(film);
  const bool has_albedo = film.find("albedo.R") != nullptr;
  return worst_difference(film, [&](std::size_t p, const std::string& letter) {
    double light = ambient * (at(film, "ao" + letter, p) - 1.0 + at(film, "A", p));
    for (const std::string& name : lights)
      light += at(film, "light." + name + letter, p) / std::numbers::pi;
    return light * (has_albedo ? at(film, "albedo" + letter, p) : 1.0);
  });
}

Light sky() {
  Light dome;
  dome.name = "sky";
  dome.kind = LightKind::dome;
  dome.radiance = V3f(0.2f, 0.3f, 0.5f);
  return dome;
}

Light sun_along(const V3f& direction) {
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = direction.normalized();
  sun.radiance = V3f(10000, 9000, 8000);
  return sun;
}

Scene small_tree() {
  Scene scene = load_scene("scene:tree?leaves=2000");
  scene.lights.resize(1);
  scene.lights[0].name = "rect";
  scene.lights[0].position = V3f(3, 12, 3);
  return scene;
}

RenderOptions small_picture() {
  RenderOptions options;
  options.width = options.height = 48;
  options.beauty = true;
  return options;
}

TEST(Beauty, IsTheSumOfWhatTheSkyAndEachLightGive) {
  RenderOptions options = small_picture();
  Scene scene = small_tree();
  const Film rect = render(scene, options).film;
  EXPECT_GT(ambient_of(rect), 0);
  EXPECT_LE(worst_sum(rect, {"rect"}), 1e-5);
  scene.lights = {sky(), sun_along({0.3f, -1, -0.4f})};
  const Film outdoors = render(scene, options).film;
  EXPECT_EQ(ambient_of(outdoors), 0) << "a dome is a sky";
  EXPECT_LE(worst_sum(outdoors, {"sky", "sun"}), 1e-5);
  options.ambient = 0.25f;
  const Film with_ambient = render(scene, options).film;
  EXPECT_EQ(ambient_of(with_ambient), 0.25);
  EXPECT_LE(worst_sum(with_ambient, {"sky", "sun"}), 1e-5);
  options.light = false;
  options.ambient = {};
  const Film grey = render(scene, options).film;
  EXPECT_EQ(ambient_of(grey), 1);
  EXPECT_LE(worst_sum(grey, {}), 1e-5);
  options.ao = false;
  EXPECT_LE(worst_sum(render(scene, options).film, {}), 1e-5);
}

TEST(Beauty, OfOneColourIsTheProductOfAlbedoAndLight) {
  RenderOptions options = small_picture();
  options.ambient = 0.25f;
  Scene scene = small_tree();
  for (Material& material : scene.materials) material.color = V3f(0.3f, 0.6f, 0.05f);
  scene.lights.push_back(sky());
  scene.lights.push_back(sun_along({0.3f, -1, -0.4f}));
  for (const Packets packets : {Packets::automatic, Packets::scalar}) {
    options.packets = packets;
    options.albedo = true;
    EXPECT_LE(worst_product(render(scene, options).film, {"rect", "sky", "sun"}), 1e-5);
    options.albedo = false;  // white
    EXPECT_LE(worst_product(render(scene, options).film, {"rect", "sky", "sun"}), 1e-5);
  }
}

// All rays of a sun bring the same, so that no noise hides a rounding.
TEST(Beauty, OfDarkSurfacesInTheSunIsNotRounded) {
  RenderOptions options = small_picture();
  options.ambient = 0.0f;
  Scene scene = small_tree();
  scene.lights = {sun_along({0.3f, -1, -0.4f})};
  for (const float dark : {0.01f, 0.0005f}) {
    for (Material& material : scene.materials) material.color = V3f(dark, 0.7f * dark, 0.3f * dark);
    EXPECT_LE(worst_product(render(scene, options).film, {"sun"}), 1e-5) << dark;
  }
}

/// A pixel sees two walls of a roof: a light one that faces the sun, and a red one that faces away.
Scene roof() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {0, -1, 1}, {0, 1, 1}, {-1, 1, 0}, {1, -1, 0}, {1, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
  Scene scene = test::scene_of(std::move(mesh));
  scene.materials.resize(2);
  scene.meshes[0].materials = {0, 0, 1, 1};
  scene.materials[0].color = V3f(0.8f, 0.7f, 0.6f);
  scene.materials[1].color = V3f(0.9f, 0.0f, 0.0f);
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 1;
  camera.to_world.setTranslation(V3f(0, 0, 5));
  scene.cameras = {camera};
  scene.lights = {sky(), sun_along({1, 0, -0.5f})};
  return scene;
}

// The sun reaches one wall only; sky and AO reach both alike, the sky with the noise of its
// samples.
TEST(Beauty, OfAPixelOfTwoColoursIsTheMeanOfWhatEachReflects) {
  RenderOptions options = small_picture();
  options.width = options.height = 1;
  options.spp = 4096;
  options.ambient = 0.25f;
  const Scene scene = roof();
  for (const Packets packets : {Packets::automatic, Packets::scalar}) {
    options.packets = packets;
    const Film film = render(scene, options).film;
    for (int c = 0; c < 3; ++c) {
      const std::string letter = std::string(".") + "RGB"[c];
      const double albedo = at(film, "albedo" + letter, 0);
      EXPECT_NEAR(albedo, 0.5 * (scene.materials[0].color[c] + scene.materials[1].color[c]), 0.01);
      const double sun = at(film, "light.sun" + letter, 0) / std::numbers::pi;
      EXPECT_NEAR(at(film, "beauty.sun" + letter, 0), scene.materials[0].color[c] * sun,
                  1e-5 * sun);
      EXPECT_NEAR(at(film, "beauty.ambient" + letter, 0), 0.25 * albedo, 1e-5);
      const double sky = at(film, "light.sky" + letter, 0) / std::numbers::pi;
      EXPECT_NEAR(at(film, "beauty.sky" + letter, 0), albedo * sky, 0.01 * sky);
    }
  }
}

// Each small pixel is the mean of 32 times 32 large ones.
TEST(Beauty, OfASmallPictureIsTheMeanOfALargeOne) {
  Scene scene = small_tree();
  scene.lights = {sky(), sun_along({0.3f, -1, -0.4f})};
  const auto means = [&](int size, int spp) {
    RenderOptions options = small_picture();
    options.width = options.height = size;
    options.spp = spp;
    options.footprint = 0;
    const Film film = render(scene, options).film;
    std::vector<double> values;
    for (const char* letter : {"R", "G", "B"}) {
      const std::vector<float>& pixels = film.find(letter)->pixels;
      values.push_back(std::accumulate(pixels.begin(), pixels.end(), 0.0) /
                       static_cast<double>(pixels.size()));
    }
    return values;
  };
  const std::vector<double> small = means(12, 4096), large = means(384, 4);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(small[c] / large[c], 1, 0.01) << c;
}

// A lamp right above the square makes some of its pixels a hundred times as bright as the sun does.
TEST(Beauty, AFewBrightPixelsMakeNoSky) {
  Mesh square;
  square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.indices = {0, 1, 2, 0, 2, 3};
  Scene scene = test::scene_of(std::move(square));
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.to_world.setTranslation(V3f(0, 0, 5));
  scene.cameras = {camera};
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(0, 0, -1);
  sun.radiance = V3f(10000);
  scene.lights = {sun};
  RenderOptions options;
  options.width = options.height = 32;
  const Film day = render(scene, options).film;
  const double irradiance = at(day, "light.sun.R", 16 * 32 + 16);
  EXPECT_NEAR(ambient_of(day), 0.1 * irradiance / std::numbers::pi, 1e-3 * irradiance);
  Light lamp;
  lamp.name = "lamp";
  lamp.kind = LightKind::disk;
  lamp.position = V3f(0.5f, 0.5f, 0.02f);
  lamp.direction = V3f(0, 0, -1);
  lamp.radius = 0.05f;
  lamp.radiance = V3f(static_cast<float>(50 * irradiance));
  scene.lights.push_back(lamp);
  const Film lit = render(scene, options).film;
  const std::vector<float>& near_lamp = lit.find("light.lamp.R")->pixels;
  EXPECT_GT(*std::max_element(near_lamp.begin(), near_lamp.end()), 50 * irradiance);
  EXPECT_LT(ambient_of(lit), 2 * ambient_of(day));
  EXPECT_GE(ambient_of(lit), ambient_of(day));
}

}  // namespace
}  // namespace dapple
