// Reports of the accuracy and paper benches. In: rows of results. Out: tables as text, JSON, and
// SVG plots.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "accuracy/image_accuracy.hpp"
#include "accuracy/node_accuracy.hpp"

namespace dapple::bench {

/// A table as text. Each column is as wide as its widest cell; the first column is left-aligned,
/// the others are right-aligned.
std::string table_text(const std::vector<std::vector<std::string>>& rows);

std::string nodes_text(const std::vector<NodeAccuracyRow>& rows);
nlohmann::json nodes_json(const std::vector<NodeAccuracyRow>& rows);

std::string images_text(const std::vector<ImageAccuracyRow>& rows);
nlohmann::json images_json(const std::vector<ImageAccuracyRow>& rows);
/// Plots converged RMSE and noise of each pass over the footprint scale, with times as labels.
std::string images_svg(const std::vector<ImageAccuracyRow>& rows, const std::string& title);

/// Writes `text` to the file, whole or not at all. Does nothing if `path` is empty. Throws Error
/// failed.
void write_report(const std::string& path, const std::string& text);

}  // namespace dapple::bench
