// RGBA recombined from its layers, and the sky that it has where the scene brings none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// The largest relative difference of RGB and its layers.
double worst_recombination(const Film& film, const std::vector<std::string>& lights) {
  const double ambient = ambient_of(film);
  double worst = 0, largest = 0;
  for (const char* letter : {"R", "G", "B"}) {
    for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
      double light = ambient * (at(film, std::string("ao.") + letter, p) - 1.0 + at(film, "A", p));
      for (const std::string& name : lights)
        light += at(film, "light." + name + "." + letter, p) / std::numbers::pi;
      const double beauty = light * at(film, std::string("albedo.") + letter, p);
      largest = std::max<double>(largest, at(film, letter, p));
      worst = std::max(worst, std::fabs(beauty - at(film, letter, p)));
    }
  }
  EXPECT_GT(largest, 0);
  return worst / largest;
}

TEST(Beauty, IsAlbedoTimesSkyAndLights) {
  RenderOptions options;
  options.width = options.height = 48;
  Scene scene = load_scene("scene:tree?leaves=2000");
  scene.lights.resize(1);
  scene.lights[0].name = "rect";
  scene.lights[0].position = V3f(3, 12, 3);
  const Film rect = render(scene, options).film;
  EXPECT_GT(ambient_of(rect), 0);
  EXPECT_LE(worst_recombination(rect, {"rect"}), 1e-5);
  Light dome;
  dome.name = "sky";
  dome.kind = LightKind::dome;
  dome.radiance = V3f(0.2f, 0.3f, 0.5f);
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(0.3f, -1, -0.4f).normalized();
  sun.radiance = V3f(10000, 9000, 8000);
  scene.lights = {dome, sun};
  const Film outdoors = render(scene, options).film;
  EXPECT_EQ(ambient_of(outdoors), 0) << "a dome is a sky";
  EXPECT_LE(worst_recombination(outdoors, {"sky", "sun"}), 1e-5);
  options.ambient = 0.25f;
  const Film with_ambient = render(scene, options).film;
  EXPECT_EQ(ambient_of(with_ambient), 0.25);
  EXPECT_LE(worst_recombination(with_ambient, {"sky", "sun"}), 1e-5);
  options.light = false;
  options.ambient = {};
  EXPECT_EQ(ambient_of(render(scene, options).film), 1);
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
