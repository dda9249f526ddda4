// What the program's help says that there is. In: the text of `dapple --help` or of a command's;
// out: the commands, and the options of the command.
#pragma once

#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace dapple::program_test {

struct Option {
  std::string flag;    ///< "--spp"
  std::string type;    ///< of its value: "TEXT", "FLOAT", "INT" or "UINT"; empty: it takes none
  std::string values;  ///< "1..100" or "{1,2}"; empty: not said
};

/// From lines such as "  -o,--output TEXT REQUIRED   OpenEXR file to write". Without --help.
inline std::vector<Option> options_in(const std::string& help) {
  static const std::set<std::string> types{"TEXT", "FLOAT", "INT", "UINT"};
  std::vector<Option> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t dashes = line.find("--");
    if (line.rfind("  -", 0) != 0 || dashes > 5) continue;
    std::istringstream words(line.substr(dashes));
    Option option;
    words >> option.flag >> option.type;
    const std::string type = option.type.substr(0, option.type.find('='));
    option.type = type.substr(0, type.find(':'));
    if (option.type != type) option.values = type.substr(option.type.size() + 1);
    if (!types.contains(option.type)) option.type.clear();
    if (option.flag != "--help") options.push_back(option);
  }
  return options;
}

/// The names below "Subcommands:", one a line.
inline std::set<std::string> commands_in(const std::string& help) {
  std::set<std::string> commands;
  std::istringstream lines(help.substr(help.find("\nSubcommands:\n") + 1));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  "))
    commands.insert(line.substr(2, line.find(' ', 2) - 2));
  return commands;
}

}  // namespace dapple::program_test
