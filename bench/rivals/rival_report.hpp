// What the rivals bench says: tables for people, JSON for programs, lines for a plot.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "accuracy/svg_plot.hpp"
#include "rivals/contest.hpp"
#include "rivals/ray_protocol.hpp"

namespace dapple::bench {

/// Build seconds and bytes a triangle of both sides, and the number of threads.
std::string building_text(const RivalScene& scene);
nlohmann::json building_json(const RivalScene& scene);

std::string rays_text(const std::vector<RayRow>& rows);
nlohmann::json rays_json(const std::vector<RayRow>& rows);

/// Seconds and RMSE at each effort, then seconds to each of `targets` with Embree's best over
/// them. `unit` says what effort counts.
std::string contest_text(const std::vector<Standing>& standings, const std::vector<double>& targets,
                         const std::string& unit);
nlohmann::json contest_json(const std::vector<Standing>& standings,
                            const std::vector<double>& targets);

/// Error against seconds.
Plot contest_plot(const std::vector<Standing>& standings, const std::string& title);

}  // namespace dapple::bench
