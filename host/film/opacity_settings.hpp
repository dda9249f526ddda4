// The opacities of `--opacity` among the settings of a film. In: materials and values. Out:
// "opacity_leaf" and "0.85", with names that differ even where layer_name() gives two materials
// one.
#pragma once

#include <fmt/format.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dapple/film.hpp"
#include "scene/free_names.hpp"

namespace dapple {

/// A material that is given twice has two settings of one name.
inline std::vector<std::pair<std::string, std::string>> opacity_settings(
    const std::vector<std::pair<std::string, float>>& opacities) {
  std::vector<std::pair<std::string, std::string>> settings;
  std::map<std::string, std::string> names;  // by material
  FreeNames free;
  for (const auto& [material, value] : opacities) {
    const auto [name, is_new] = names.try_emplace(material);
    if (is_new) name->second = free.take("opacity_" + layer_name(material));
    settings.emplace_back(name->second, fmt::format("{}", value));
  }
  return settings;
}

}  // namespace dapple
