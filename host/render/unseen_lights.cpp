#include "render/unseen_lights.hpp"

#include <algorithm>

#include "film/light_layers.hpp"
#include "scene/lights/dark_light.hpp"

namespace dapple {
namespace {

bool is_zero(const Film& film, const std::string& channel) {
  const Plane* plane = film.find(channel);
  return plane == nullptr || std::none_of(plane->pixels.begin(), plane->pixels.end(),
                                          [](float value) { return value > 0; });
}

/// Whether there is such a layer, and it is not black.
bool shines(const Film& film, const std::string& layer) {
  return film.find(layer + ".R") != nullptr &&
         (!is_zero(film, layer + ".R") || !is_zero(film, layer + ".G") ||
          !is_zero(film, layer + ".B"));
}

}  // namespace

// The commonest mistake is a sun whose direction is that to the sun.
std::vector<std::string> notes_of_unseen_lights(const Film& film,
                                                const std::vector<Light>& lights) {
  std::vector<std::string> notes;
  if (is_zero(film, "A")) return notes;
  for (const LightLayer& layer : light_layers(lights)) {
    const std::string name = "light." + layer.name;
    const auto is_dark_at = [&](std::size_t l) { return is_dark(lights[l]); };
    if (std::all_of(layer.lights.begin(), layer.lights.end(), is_dark_at) ||
        film.find(name + ".R") == nullptr || shines(film, name) || shines(film, name + ".back"))
      continue;
    const Light& first = lights[layer.lights[0]];
    const bool rises = first.kind == LightKind::sun && first.direction.y > 0;
    notes.push_back(name + " reaches nothing that is seen" +
                    (rises ? ": its direction, in which its light travels, is upwards" : ""));
  }
  return notes;
}

}  // namespace dapple
