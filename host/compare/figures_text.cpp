#include "compare/figures_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "compare/worst_window.hpp"

namespace dapple {
namespace {

std::string figure(double value) { return fmt::format("{:.6g}", value); }
std::string count(std::size_t value) { return value == 0 ? kAbsent : std::to_string(value); }
std::string rect_text(const PixelRect& r) {
  return fmt::format("{},{},{},{}", r.x0, r.y0, r.x1, r.y1);
}

using D = const LayerDifference&;

constexpr FigureColumn kColumns[] = {
    {"layer", "", [](D d) { return d.layer; }, true},
    {"mean A", "mean over pixels and channels", [](D d) { return figure(d.mean_a); }, true},
    {"mean B", "the same of B", [](D d) { return figure(d.mean_b); }, true},
    {"A - B", "mean difference", [](D d) { return figure(d.mean_difference); }, true},
    {"RMSE", "root of the mean squared difference", [](D d) { return figure(d.rmse); }, true},
    {"rel. MSE", "mean of (A - B)^2 / (B^2 + 0.01)", [](D d) { return figure(d.relative_mse); },
     true},
    {"RMSE/largest", "RMSE over the light's largest value in B",
     [](D d) { return d.rmse_of_largest ? figure(*d.rmse_of_largest) : kAbsent; }, false},
    {"max |A-B|", "largest difference", [](D d) { return figure(d.max_difference); }, true},
    {"at", "its pixel, from the top left, and channel",
     [](D d) {
       return d.max_difference > 0 ? fmt::format("{},{} {}", d.max_x, d.max_y, d.max_channel)
                                   : kAbsent;
     },
     true},
    {"worst RMSE", "RMSE of the window, at most 32 pixels wide and tall, that differs most",
     [](D d) { return figure(d.window_rmse); }, true},
    {"worst window", "X0,Y0,X1,Y1 of that window, as --crop takes them",
     [](D d) { return rect_text(d.window); }, true},
    {"infinite", "values infinite in one picture and not the same in the other",
     [](D d) { return count(d.infinity_mismatches); }, false},
    {"NaN", "values that are NaN in either picture", [](D d) { return count(d.nans); }, false},
};
static_assert(kRelativeEpsilon == 0.01 && kWindowSide == 32, "the meanings above say so");

// One column's lines, heading first, padded to one width. The first column is aligned left, all
// others right.
std::vector<std::string> padded(const FigureColumn& column, const Comparison& comparison) {
  std::vector<std::string> lines{column.heading};
  for (const LayerDifference& layer : comparison.layers) lines.push_back(column.cell(layer));
  const auto widest =
      std::max_element(lines.begin(), lines.end(), [](const auto& a, const auto& b) {
        return a.size() < b.size();
      })->size();
  for (std::string& line : lines) {
    line = &column == kColumns ? fmt::format("{:<{}}", line, widest)
                               : fmt::format("  {:>{}}", line, widest);
  }
  return lines;
}

bool is_shown(const FigureColumn& column, const Comparison& comparison) {
  return column.always ||
         std::any_of(comparison.layers.begin(), comparison.layers.end(),
                     [&](const LayerDifference& layer) { return column.cell(layer) != kAbsent; });
}

std::string only_text(const std::string& name, const std::vector<std::string>& layers) {
  if (layers.empty()) return {};
  std::string text = "only in " + name + ":";
  for (const std::string& layer : layers) text += " " + layer;
  return text + "\n";
}

nlohmann::ordered_json layer_json(const LayerDifference& d) {
  nlohmann::ordered_json json;
  json["layer"] = d.layer;
  json["values"] = d.values;
  json["mean_a"] = d.mean_a;
  json["mean_b"] = d.mean_b;
  json["mean_difference"] = d.mean_difference;
  json["rmse"] = d.rmse;
  json["relative_mse"] = d.relative_mse;
  json["largest_b"] = d.largest_b;
  if (d.rmse_of_largest) json["rmse_of_largest"] = *d.rmse_of_largest;
  json["max_difference"] = {
      {"value", d.max_difference}, {"channel", d.max_channel}, {"pixel", {d.max_x, d.max_y}}};
  json["worst_window"] = {{"rmse", d.window_rmse},
                          {"rect", {d.window.x0, d.window.y0, d.window.x1, d.window.y1}}};
  json["infinity_mismatches"] = d.infinity_mismatches;
  json["nans"] = d.nans;
  return json;
}

}  // namespace

std::span<const FigureColumn> figure_columns() { return kColumns; }

std::string comparison_text(const Comparison& comparison) {
  std::vector<std::string> lines(comparison.layers.size() + 1);
  for (const FigureColumn& column : kColumns) {
    if (!is_shown(column, comparison)) continue;
    const std::vector<std::string> cells = padded(column, comparison);
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i] += cells[i];
  }
  std::string text = fmt::format("A = {}, B = {}: {} x {} pixels\n", comparison.name_a,
                                 comparison.name_b, comparison.width, comparison.height);
  for (const std::string& line : lines) text += line + "\n";
  return text + only_text("A", comparison.only_a) + only_text("B", comparison.only_b);
}

nlohmann::ordered_json comparison_json(const Comparison& comparison, const std::string& failure) {
  nlohmann::ordered_json json;
  json["a"] = comparison.name_a;
  json["b"] = comparison.name_b;
  json["width"] = comparison.width;
  json["height"] = comparison.height;
  json["relative_mse_epsilon"] = kRelativeEpsilon;
  json["layers"] = nlohmann::ordered_json::array();
  for (const LayerDifference& layer : comparison.layers)
    json["layers"].push_back(layer_json(layer));
  json["only_in_a"] = comparison.only_a;
  json["only_in_b"] = comparison.only_b;
  json["passed"] = failure.empty();
  json["failure"] = failure;
  return json;
}

}  // namespace dapple
