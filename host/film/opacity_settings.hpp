// The opacities of `--opacity` among the settings of a film. In: materials and values. Out:
// "opacity_leaf" and "0.85", with names that differ even where layer_name() gives two materials
// one.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "dapple/film.hpp"
#include "scene/free_names.hpp"

namespace dapple {

/// Of a material that is given twice, the last value counts.
inline std::vector<std::pair<std::string, std::string>> opacity_settings(
    const std::vector<std::pair<std::string, float>>& opacities) {
  std::vector<std::pair<std::string, std::string>> settings;
  FreeNames names;
  for (auto one = opacities.begin(); one != opacities.end(); ++one) {
    const bool is_replaced = std::any_of(
        one + 1, opacities.end(), [&](const auto& later) { return later.first == one->first; });
    if (!is_replaced)
      settings.emplace_back(names.take("opacity_" + layer_name(one->first)),
                            fmt::format("{}", one->second));
  }
  return settings;
}

}  // namespace dapple
