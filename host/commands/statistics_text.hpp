// Render statistics as text for people and as JSON for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "dapple/render.hpp"

namespace dapple {

nlohmann::ordered_json statistics_json(const RenderStatistics& statistics);
std::string statistics_text(const RenderStatistics& statistics);

/// Writes them as JSON.
void write_statistics(const RenderStatistics& statistics, const std::string& path);

/// By layer or value.
nlohmann::ordered_json bias_json(const std::map<std::string, Bias>& layers);
/// A line for each layer or value.
std::string bias_lines(const std::map<std::string, Bias>& layers);

/// The text of a JSON file. Bytes of paths that are not UTF-8 are replaced.
std::string json_text(const nlohmann::ordered_json& json);

/// "1.7 GB", "512 kB", "12 bytes".
std::string bytes_text(double bytes);

}  // namespace dapple
