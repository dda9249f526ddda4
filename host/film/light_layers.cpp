#include "film/light_layers.hpp"

#include <map>
#include <set>

#include "dapple/film.hpp"
#include "film/layers.hpp"
#include "scene/free_names.hpp"

namespace dapple {
namespace {

/// The names of lights and of layers.
struct Names {
  std::vector<std::string> lights;
  std::vector<LightLayer> layers;
};

/// Gives the lights names, those in groups or the others. The first ones keep theirs.
void name_lights(const std::vector<Light>& lights, bool in_groups, FreeNames& free,
                 std::vector<std::string>& names) {
  std::set<std::string> known;
  std::vector<std::size_t> later;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    if (lights[l].group.empty() == in_groups) continue;
    names[l] = layer_name(lights[l].name);
    if (known.insert(names[l]).second)
      names[l] = free.take(names[l]);
    else
      later.push_back(l);
  }
  for (const std::size_t l : later) names[l] = free.take(names[l]);
}

Names names_of(const std::vector<Light>& lights) {
  FreeNames free;
  Names names;
  names.lights.resize(lights.size());
  name_lights(lights, false, free, names.lights);
  std::map<std::string, std::size_t> layer_of_group;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const std::string& group = lights[l].group;
    if (group.empty()) {
      names.layers.push_back({names.lights[l], {l}});
      continue;
    }
    const auto [found, is_new] = layer_of_group.try_emplace(group, names.layers.size());
    if (is_new) names.layers.push_back({free.take(layer_name(group)), {}});
    names.layers[found->second].lights.push_back(l);
  }
  name_lights(lights, true, free, names.lights);
  return names;
}

}  // namespace

std::vector<std::string> light_names(const std::vector<Light>& lights) {
  return names_of(lights).lights;
}

std::vector<LightLayer> light_layers(const std::vector<Light>& lights) {
  return names_of(lights).layers;
}

std::string ambient_layer_name(const std::vector<LightLayer>& layers) {
  FreeNames names;
  for (const LightLayer& layer : layers) names.reserve(layer.name);
  return names.take("ambient");
}

}  // namespace dapple
