#include "commands/arguments/argument_errors.hpp"

#include <fmt/format.h>

#include <regex>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// The command that was parsed, or the program.
const CLI::App& parsed_command(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : *commands.front();
}

/// Values that an option of this type takes, by CLI11's name of the type; `text` is none of them.
std::string expected_values(const CLI::App& app, const std::string& flag, const std::string& text) {
  const CLI::Option* option = parsed_command(app).get_option_no_throw(flag);
  const std::string type = option ? option->get_type_name() : "";
  const bool is_whole = std::regex_match(text, std::regex("[+-]?\\d+"));
  std::smatch values;
  if (std::regex_match(type, values, std::regex("U?INT:(-?\\d+)\\.\\.(\\d+)")))
    return fmt::format("a whole number from {} to {}", values[1].str(), values[2].str());
  if (std::regex_match(type, values, std::regex("FLOAT:(.*)\\.\\.(.*)")))
    return fmt::format("a number from {} to {}", values[1].str(), values[2].str());
  if (std::regex_match(type, values, std::regex("U?INT:\\{(.*)\\}")))
    return "one of " + std::regex_replace(values[1].str(), std::regex(","), ", ");
  if (type == "UINT")
    return is_whole ? "a whole number from 0 to 4294967295" : "a whole number, 0 or more";
  if (type == "INT" && is_whole) return "a whole number of at most nine digits";
  if (type == "INT") return "a whole number";
  if (type == "FLOAT") return "a number";
  return "another value";
}

/// Whole numbers are decimal, also with zeros before them: scripts write 0008.
void read_as_decimal(CLI::Option& option) {
  option.transform([](std::string text) {
    const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
    if (text.find_first_not_of("0123456789", sign) != std::string::npos) return text;
    while (text.size() > sign + 1 && text[sign] == '0') text.erase(sign, 1);
    return text;
  });
  option.check([](const std::string& text) {
    return text.find_first_of("xX") != std::string::npos ? text + " is not a decimal number"
                                                         : std::string();
  });
}

bool takes_number(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.starts_with("UINT") || type.starts_with("INT") || type.starts_with("FLOAT");
}

/// "--output" of "-o,--output".
std::string long_name(const std::string& names) {
  const std::size_t comma = names.rfind(',');
  return comma == std::string::npos ? names : names.substr(comma + 1);
}

std::string mismatch_text(const std::string& what) {
  std::smatch match;
  if (std::regex_match(what, match, std::regex("([^:]*): At Most (\\d+) required.*")))
    return fmt::format("{} is given more than once", long_name(match[1]));
  if (std::regex_match(what, match, std::regex("([^:]*): .*required.*missing")))
    return fmt::format("{} needs a value", long_name(match[1]));
  if (std::regex_match(what, match, std::regex("([^:]*): At least (\\d+) required .* (\\d+)")))
    return fmt::format("{} has {} numbers; it needs {}, with commas between", long_name(match[1]),
                       match[3].str(), match[2].str());
  return what;
}

/// An option that takes several values may have taken the argument that is missing.
std::string missing_text(const CLI::App& command, const std::string& missing) {
  const auto took_many = [](const CLI::Option* option) {
    return !option->get_positional() && option->get_allow_extra_args() && option->count() > 0;
  };
  const auto lists = command.get_options(took_many);
  if (missing.starts_with("-") || lists.empty()) return missing + " is missing";
  const std::string list = "--" + lists.front()->get_lnames().front();
  return fmt::format(
      "{0} is missing: {1} takes all files that follow it; write {0} before {1}, or "
      "after --, as in {1} FILE... -- {0}",
      missing, list);
}

/// CLI11 lists them from the last to the first.
std::string extras_text(const CLI::App& app) {
  std::vector<std::string> extras = parsed_command(app).remaining();
  if (extras.empty()) extras = app.remaining(true);
  if (extras.empty()) return "there is an argument too many";
  const std::string& first = extras.front();
  if (app.get_subcommands().empty() && !first.starts_with("-"))
    return fmt::format("there is no command {}", first);
  if (first.starts_with("-")) return fmt::format("there is no option {}", first);
  return fmt::format("'{}' is an argument too many", first);
}

}  // namespace

std::string argument_error_text(const CLI::App& app, const CLI::ParseError& error) {
  const std::string what = error.what(), name = error.get_name();
  std::smatch match;
  if (name == "ConversionError" &&
      std::regex_match(what, match, std::regex("Could not convert: (\\S+) = (.*)"))) {
    const std::string flag = long_name(match[1]);
    return fmt::format("{} {}: expected {}", flag, match[2].str(),
                       expected_values(app, flag, match[2].str()));
  }
  if (name == "ArgumentMismatch") return mismatch_text(what);
  // Its name is that of the command.
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError))
    return extras_text(app);
  if (name == "RequiredError" && std::regex_match(what, match, std::regex("(\\S+) is required")))
    return missing_text(parsed_command(app), long_name(match[1]));
  if (name == "RequiresError" &&
      std::regex_match(what, match, std::regex("(\\S+) requires (\\S+)")))
    return fmt::format("{} needs {}", long_name(match[1]), long_name(match[2]));
  if (name == "ExcludesError" &&
      std::regex_match(what, match, std::regex("(\\S+) excludes (\\S+)")))
    return fmt::format("{} does not go with {}", long_name(match[1]), long_name(match[2]));
  return error.what();
}

CLI::Validator of_values(const std::string& values) {
  return {[](std::string&) { return std::string(); }, values};
}

void refuse_empty_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_expected_max() == 0) continue;  // a flag
    const std::string type = option->get_type_name();
    if (type.starts_with("UINT") || type.starts_with("INT")) read_as_decimal(*option);
    const std::string what = takes_number(*option) ? "number" : "value";
    option->check([what](const std::string& text) {
      return text.empty() ? fmt::format("needs a {}, its value is empty", what) : std::string();
    });
  }
}

void refuse_missing_values(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string text = argv[i];
    if (text.size() > 3 && text.starts_with("--") && text.find('=') == text.size() - 1)
      throw Error(ErrorKind::usage, fmt::format("{}: needs a value, its value is empty",
                                                text.substr(0, text.size() - 1)));
  }
}

}  // namespace dapple
