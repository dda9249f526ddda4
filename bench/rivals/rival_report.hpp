// Reports of the rivals bench. In: measurements. Out: tables as text, JSON, and plots.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "accuracy/svg_plot.hpp"
#include "rivals/contest.hpp"
#include "rivals/protocols/ray_protocol.hpp"

namespace dapple::bench {

/// Build times and bytes per triangle of both programs, and the number of threads.
std::string building_text(const RivalScene& scene);
nlohmann::json building_json(const RivalScene& scene);

std::string rays_text(const std::vector<RayRow>& rows);
nlohmann::json rays_json(const std::vector<RayRow>& rows);

/// Seconds and RMSE at each effort, then the seconds to each of `targets` and the ratio of Embree's
/// best time to them. `unit` is the unit of effort.
std::string contest_text(const std::vector<Standing>& standings, const std::vector<double>& targets,
                         const std::string& unit);
nlohmann::json contest_json(const std::vector<Standing>& standings,
                            const std::vector<double>& targets);

/// Error over seconds.
Plot contest_plot(const std::vector<Standing>& standings, const std::string& title);

}  // namespace dapple::bench
