// Errors of the command line in the program's own words. In: what CLI11 throws. Out: one line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dapple {

/// What is wrong, and what is expected. `app`: the program, whose parsing threw `error`.
std::string argument_error_text(const CLI::App& app, const CLI::ParseError& error);

}  // namespace dapple
