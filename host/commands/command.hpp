// The commands of the program. Each adds its options to the command line and returns
// what to run once they are parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace dapple {

/// Throws Error; main() turns it into an exit code.
using Run = std::function<void()>;

Run add_render_command(CLI::App& app);
Run add_merge_command(CLI::App& app);
Run add_plan_command(CLI::App& app);
Run add_bake_command(CLI::App& app);
Run add_points_command(CLI::App& app);
Run add_info_command(CLI::App& app);
Run add_scene_command(CLI::App& app);
Run add_devices_command(CLI::App& app);
Run add_compare_command(CLI::App& app);
Run add_compile_command(CLI::App& app);
Run add_document_command(CLI::App& app);

/// One line; `verbose`: also how dapple was built and which device libraries there are.
void print_version(bool verbose);

}  // namespace dapple
