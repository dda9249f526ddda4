// Lights of a group share one layer: the sum of what each light gives alone.
#include <gtest/gtest.h>

#include "film/layers.hpp"
#include "film/light_layers.hpp"
#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

Light light_of(const std::string& name, const std::string& group,
               LightKind kind = LightKind::sphere) {
  Light light;
  light.name = name;
  light.group = group;
  light.kind = kind;
  light.position = {0.3f, 3, 0};
  light.direction = V3f(0.2f, -1, 0).normalized();
  return light;
}

std::vector<std::string> names_of(const std::vector<Light>& lights) {
  std::vector<std::string> names;
  for (const LightLayer& layer : light_layers(lights)) names.push_back(layer.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(LightLayers, AreInTheOrderOfTheirFirstLights) {
  const std::vector<Light> lights = {light_of("a", "rim"), light_of("b", ""), light_of("c", "rim"),
                                     light_of("d", "fill")};
  EXPECT_EQ(names_of(lights), (Names{"rim", "b", "fill"}));
  EXPECT_EQ(light_layers(lights)[0].lights, (std::vector<std::size_t>{0, 2}));
}

TEST(LightLayers, HaveNamesThatDiffer) {
  EXPECT_EQ(names_of({light_of("a", ""), light_of("b", "a"), light_of("a", "")}),
            (Names{"a", "a_3", "a_2"}));
  EXPECT_EQ(names_of({light_of("x", "back light"), light_of("y", "back_light")}),
            (Names{"back_light", "back_light_2"}));
  EXPECT_EQ(names_of({light_of("a", ""), light_of("a", ""), light_of("a_2", "")}),
            (Names{"a", "a_3", "a_2"}))
      << "a name that only one light has stays";
}

// Errors and biases are by light or by layer, so that one name must not be of both.
TEST(LightLayers, LightsInGroupsHaveNoNameOfALayer) {
  const std::vector<Light> lights = {light_of("rim", "rim"), light_of("a", "rim"),
                                     light_of("a", "")};
  EXPECT_EQ(names_of(lights), (Names{"rim", "a"}));
  EXPECT_EQ(light_names(lights), (Names{"rim_2", "a_2", "a"}));
}

// As of a field of lamps: instances of a mesh light have its name.
TEST(LightLayers, ManyOfOneNameAreNamedAtOnce) {
  const std::vector<std::string> names =
      light_names(std::vector<Light>(30'000, light_of("lamp", "")));
  EXPECT_EQ(names.front(), "lamp");
  EXPECT_EQ(names.back(), "lamp_30000");
}

TEST(LightLayers, OfAGroupAreTheSumOfItsLightsWithinFloatRounding) {
  Scene scene = make_procedural("scene:tree?leaves=500");
  scene.cameras = {frame_scene(scene, 1)};
  scene.lights = {light_of("sun", "", LightKind::sun), light_of("sphere", ""),
                  light_of("dome", "", LightKind::dome), light_of("far", "", LightKind::sun)};
  scene.lights[0].radiance = V3f(9000, 8000, 7000);
  scene.lights[1].radiance = V3f(10, 30, 20);
  RenderOptions options;
  options.width = options.height = 24;
  options.spp = 4;
  const Film apart = render(scene, options).film;
  for (const std::size_t l : {0u, 1u, 2u}) scene.lights[l].group = "all";
  const Film together = render(scene, options).film;
  EXPECT_EQ(together.find("light.sun.R"), nullptr);
  double largest = 0;
  for (const char channel : {'R', 'G', 'B'}) {
    const auto pixels = [&](const Film& film, const std::string& layer) {
      return film.find(layer + "." + channel)->pixels;
    };
    EXPECT_EQ(pixels(together, "light.far"), pixels(apart, "light.far"));
    const auto sum = pixels(together, "light.all");
    const auto a = pixels(apart, "light.sun"), b = pixels(apart, "light.sphere"),
               c = pixels(apart, "light.dome");
    for (std::size_t p = 0; p < sum.size(); ++p) {
      const double parts = double{a[p]} + b[p] + c[p];
      EXPECT_NEAR(sum[p], parts, 2e-7 * parts) << p;  // each of four roundings is at most 6e-8
      largest = std::max(largest, parts);
    }
  }
  EXPECT_GT(largest, 0.1);
}

TEST(LightLayers, ErrorsStayThoseOfEachLight) {
  Scene scene = point_on_ground();
  scene.lights = {light_of("a", "g"), light_of("b", "g", LightKind::sun)};
  RenderOptions options = one_pixel();
  options.light_rays = options.ao_rays = 4;
  options.target_error = 0.2f;
  options.max_spp = 64;
  const RenderResult result = render(scene, options);
  for (const char* layer : {"error.light.a", "error.light.b", "light.g.R"})
    EXPECT_NE(result.film.find(layer), nullptr) << layer;
  EXPECT_EQ(result.film.find("error.light.g"), nullptr);
}

}  // namespace
}  // namespace dapple
