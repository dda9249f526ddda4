// What the accuracy and paper benches write down: tables for people, JSON for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "accuracy/image_accuracy.hpp"
#include "accuracy/node_accuracy.hpp"

namespace dapple::bench {

/// Cells as text, columns as wide as their widest cell, the first flush left.
std::string table_text(const std::vector<std::vector<std::string>>& rows);

std::string nodes_text(const std::vector<NodeAccuracyRow>& rows);
nlohmann::json nodes_json(const std::vector<NodeAccuracyRow>& rows);

std::string images_text(const std::vector<ImageAccuracyRow>& rows);
nlohmann::json images_json(const std::vector<ImageAccuracyRow>& rows);
/// Converged RMSE and noise of each pass against the footprint, times as labels.
std::string images_svg(const std::vector<ImageAccuracyRow>& rows, const std::string& title);

/// Writes `text` whole or not at all; nothing where `path` is empty. Throws Error failed.
void write_report(const std::string& path, const std::string& text);

}  // namespace dapple::bench
