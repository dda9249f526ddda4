// Options that several commands have. In: the command line and the variables that the options set.
// Out: the options, with the same names and descriptions in every command.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dapple {

/// --estimator, --footprint and --report-bias; returns --footprint
CLI::Option* add_prefiltering_options(CLI::App& app, std::string& estimator, float& footprint,
                                      std::string& report_bias);

/// --max-bias of commands that choose no footprint without it
void add_max_bias_option(CLI::App& app, float& max_bias);

/// --allow-outside
void add_outside_option(CLI::App& app, bool& allow_outside);

/// --device, --kernel-dir and --cache
void add_device_options(CLI::App& app, std::string& device, std::string& kernel_dir,
                        std::string& cache);

/// --stats-json and --quiet
void add_report_options(CLI::App& app, std::string& stats_json, bool& quiet);

}  // namespace dapple
