// Notes about lights that reach nothing of what a picture shows.
#include "render/unseen_lights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

Light sun_along(const V3f& direction, const std::string& name) {
  Light sun;
  sun.kind = LightKind::sun;
  sun.name = name;
  sun.direction = direction.normalized();
  return sun;
}

std::vector<std::string> notes_of(Scene scene, const std::vector<Light>& lights) {
  scene.lights = lights;
  RenderOptions options;
  options.width = options.height = 24;
  options.spp = 2;
  std::vector<std::string> notes = render(scene, options).statistics.notes;
  std::erase_if(notes, [](const std::string& note) { return !note.starts_with("light."); });
  return notes;
}

TEST(UnseenLights, EachHasANoteThatTellsOfDirectionsUpwards) {
  const Scene cube = make_procedural("scene:cube");
  Light inside = sun_along({0, 1, 0}, "inside");
  inside.kind = LightKind::sphere;
  inside.position = scene_bounds(cube).center();
  inside.radius = 0.01f;
  Light dark = sun_along({0, 1, 0}, "dark");
  dark.radiance = V3f(0, 0, 0);
  const std::vector<std::string> notes = notes_of(
      cube,
      {sun_along({0.3f, -1, -0.8f}, "good"), sun_along({0.2f, 1, 0.5f}, "rising"), inside, dark});
  EXPECT_EQ(notes,
            (std::vector<std::string>{
                "light.rising reaches nothing that is seen: its direction, in which its light "
                "travels, is upwards",
                "light.inside reaches nothing that is seen"}));
}

TEST(UnseenLights, OfAGroupOneThatIsSeenIsEnough) {
  std::vector<Light> lights = {sun_along({0, 1, 0}, "a"), sun_along({0.3f, -1, -0.8f}, "b")};
  for (Light& light : lights) light.group = "both";
  EXPECT_TRUE(notes_of(make_procedural("scene:cube"), lights).empty());
}

TEST(UnseenLights, WhereNothingIsSeenThereIsNothingToSay) {
  Film film;
  film.planes = {
      {"A", {0, 0}}, {"light.a.R", {0, 0}}, {"light.a.G", {0, 0}}, {"light.a.B", {0, 0}}};
  EXPECT_TRUE(notes_of_unseen_lights(film, {sun_along({0, 1, 0}, "a")}).empty());
  film.planes[0].pixels[0] = 1;
  EXPECT_EQ(notes_of_unseen_lights(film, {sun_along({0, 1, 0}, "a")}).size(), 1u);
  for (const char* channel : {"light.a.back.R", "light.a.back.G", "light.a.back.B"})
    film.planes.push_back({channel, {0, 1}});
  EXPECT_TRUE(notes_of_unseen_lights(film, {sun_along({0, 1, 0}, "a")}).empty())
      << "what is behind is seen";
}

}  // namespace
}  // namespace dapple
