// The figures of a comparison as a table of text and as JSON. In: a Comparison. Out: text for
// people, JSON for programs, and the columns, which the HTML page shows as well.
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

/// The text of a figure that does not apply, and of a count of zero.
inline constexpr const char* kAbsent = "-";

/// All columns; the first is the layer's name.
std::span<const FigureColumn> figure_columns();

std::string comparison_text(const Comparison& comparison);
/// Names need not be valid UTF-8, so the caller must dump it with `error_handler_t::replace`.
nlohmann::ordered_json comparison_json(const Comparison& comparison, const std::string& failure);

}  // namespace dapple
