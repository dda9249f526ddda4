// The bias that a call measured, by layer, as tuples for dapple.Bias.
#pragma once

#include <map>
#include <string>
#include <tuple>

#include "dapple/bias.hpp"

namespace dapple::python {

/// The fields of Bias in their order.
using BiasFields = std::tuple<double, double, double, double, double>;

inline std::map<std::string, BiasFields> bias_fields(const std::map<std::string, Bias>& layers) {
  std::map<std::string, BiasFields> fields;
  for (const auto& [layer, bias] : layers)
    fields[layer] = {bias.mean, bias.error, bias.tile_rmse, bias.tile_rmse_limit, bias.share};
  return fields;
}

}  // namespace dapple::python
