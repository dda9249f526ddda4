// The figures of a comparison as people and as programs read them. Text and HTML show the
// same columns; one table says what they are.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "compare/difference.hpp"

namespace dapple {

struct FigureColumn {
  const char* heading;
  const char* meaning;
  std::string (*cell)(const LayerDifference&);
  bool always;  ///< shown even where every cell is kAbsent
};

/// A figure that does not apply, or a count of zero.
inline constexpr const char* kAbsent = "-";

/// The layer's name first.
std::span<const FigureColumn> figure_columns();

std::string comparison_text(const Comparison& comparison);
/// Names may not be UTF-8: dump it with `error_handler_t::replace`.
nlohmann::ordered_json comparison_json(const Comparison& comparison, const std::string& failure);

}  // namespace dapple
