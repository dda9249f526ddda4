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

/// "1.7 GB", "512 kB", "12 bytes".
std::string bytes_text(double bytes);

}  // namespace dapple
