// Which lights share a layer. In: the lights of a scene. Out: names and members of layers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The layer `light.NAME`: one light, or all lights of a group, whose irradiances add up.
struct LightLayer {
  std::string name;                 ///< what comes after "light."; all are different
  std::vector<std::size_t> lights;  ///< indices, ascending
};

/// The layers in the order of their first lights. Lights in no group are named first, then groups,
/// then lights in groups (light_names()), so that no light has the name of another's layer.
std::vector<LightLayer> light_layers(const std::vector<Light>& lights);

/// The name beside them of what the sky of AO gives: "ambient", with a number if a light has it.
std::string ambient_layer_name(const std::vector<LightLayer>& layers);

/// Sums over the lights of each layer: values[light] is anything with begin(), end() and +=.
template <class Values>
std::vector<Values> sums_of_layers(const std::vector<LightLayer>& layers,
                                   const std::vector<Values>& values) {
  std::vector<Values> sums;
  for (const LightLayer& layer : layers) {
    sums.push_back(values[layer.lights[0]]);
    for (std::size_t l = 1; l < layer.lights.size(); ++l) {
      auto to = sums.back().begin();
      for (const auto& value : values[layer.lights[l]]) *to++ += value;
    }
  }
  return sums;
}

}  // namespace dapple
