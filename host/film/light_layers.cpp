#include "film/light_layers.hpp"

#include <map>
#include <set>

#include "dapple/film.hpp"
#include "film/layers.hpp"

namespace dapple {
namespace {

std::string name_that_is_free(const std::string& base, std::set<std::string>& taken) {
  std::string name = base;
  for (int n = 2; !taken.insert(name).second; ++n) name = base + "_" + std::to_string(n);
  return name;
}

}  // namespace

std::vector<LightLayer> light_layers(const std::vector<Light>& lights) {
  const std::vector<std::string> names = light_names(lights);
  std::set<std::string> taken;
  for (std::size_t l = 0; l < lights.size(); ++l)
    if (lights[l].group.empty()) taken.insert(names[l]);
  std::vector<LightLayer> layers;
  std::map<std::string, std::size_t> layer_of_group;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const std::string& group = lights[l].group;
    if (group.empty()) {
      layers.push_back({names[l], {l}});
      continue;
    }
    const auto [found, is_new] = layer_of_group.try_emplace(group, layers.size());
    if (is_new) layers.push_back({name_that_is_free(layer_name(group), taken), {}});
    layers[found->second].lights.push_back(l);
  }
  return layers;
}

std::string ambient_layer_name(const std::vector<LightLayer>& layers) {
  std::set<std::string> taken;
  for (const LightLayer& layer : layers) taken.insert(layer.name);
  return name_that_is_free("ambient", taken);
}

}  // namespace dapple
