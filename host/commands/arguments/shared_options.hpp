// Options that several commands have. In: the command line and the variables that the options set.
// Out: the options, with the same names and descriptions in every command.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dapple {

/// --estimator, --footprint and --report-bias; returns --footprint
CLI::Option* add_prefiltering_options(CLI::App& app, std::string& estimator, float& footprint,
                                      std::string& report_bias);

/// --max-bias of commands that choose no footprint without it
void add_max_bias_option(CLI::App& app, float& max_bias);

/// --opacity, once for each material
void add_opacity_option(CLI::App& app, std::vector<std::string>& opacity);

/// --ao-distance and --ao-falloff
void add_ao_range_options(CLI::App& app, float& distance, float& falloff);

/// `flag`, such as --dome-rotation: degrees
/// `what`: the thing that turns, for the help.
void add_rotation_option(CLI::App& app, const std::string& flag, const char* what, double& degrees);

/// Light::rotation for so many degrees; throws Error usage, naming `flag`, if they are not finite.
float dome_rotation(const std::string& flag, double degrees);

/// --light-radius
void add_light_radius_option(CLI::App& app, float& radius);

/// --allow-outside
void add_outside_option(CLI::App& app, bool& allow_outside);

/// --device, --kernel-dir and --cache
void add_device_options(CLI::App& app, std::string& device, std::string& kernel_dir,
                        std::string& cache);

/// --stats-json and --quiet
void add_report_options(CLI::App& app, std::string& stats_json, bool& quiet);

}  // namespace dapple
