// Errors of the command line in the program's own words. In: what CLI11 throws. Out: one line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dapple {

/// What is wrong, and what is expected. `app`: the program, whose parsing threw `error`.
std::string argument_error_text(const CLI::App& app, const CLI::ParseError& error);

/// Does not check: it tells the values of an option, "1..100" or "{0,1,2}", in the help and where
/// the argument is no number. The command refuses others.
CLI::Validator of_values(const std::string& values);

/// Makes it an error to give an option of the command an empty value, which CLI11 reads as 0 or as
/// no option: a script with an unset variable would render something else.
void refuse_empty_values(CLI::App& command);

/// Throws Error usage for "--option=", for which CLI11 takes the next argument.
void refuse_missing_values(int argc, const char* const* argv);

}  // namespace dapple
