// dapple document: writes the manual page and the shells' completions from the options that the
// commands define, so that there is one text of each. It is hidden from --help; the build runs it.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "commands/command.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

std::vector<const CLI::App*> shown_commands(const CLI::App& program) {
  std::vector<const CLI::App*> shown;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) shown.push_back(command);
  return shown;
}

std::vector<const CLI::Option*> shown_options(const CLI::App& command) {
  std::vector<const CLI::Option*> shown;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_group().empty()) shown.push_back(option);
  return shown;
}

/// "-o", "--output": as they are typed.
std::vector<std::string> flags_of(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  return flags;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// Text of a troff line: no escapes, no hyphens that become dashes, no control line.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

void print_option(const CLI::Option& option) {
  std::string names;
  for (const std::string& flag : flags_of(option))
    names += (names.empty() ? "\\fB" : ", \\fB") + troff(flag) + "\\fR";
  if (names.empty())
    names = "\\fI" + troff(option.get_name(true)) + "\\fR";
  else if (takes_value(option))
    names += " \\fI" + troff(option.get_type_name()) + "\\fR";
  const std::string initial = option.get_default_str();
  put(".TP\n{}\n{}{}\n", names, troff(option.get_description()),
      initial.empty() ? "" : troff(" (default: " + initial + ")"));
}

void print_footer(const CLI::App& app) {
  if (!app.get_footer().empty()) put(".PP\n.nf\n{}\n.fi\n", troff(app.get_footer()));
}

void print_manual(const CLI::App& program) {
  put(".TH DAPPLE 1 \"\" \"dapple {0}\" \"User Commands\"\n.SH NAME\ndapple \\- ", DAPPLE_VERSION);
  const std::string& about = program.get_description();
  const std::size_t line = about.find('\n');
  put("{}\n.SH SYNOPSIS\n", troff(about.substr(0, std::min(line, about.size()) - 1)));
  for (const CLI::App* command : shown_commands(program))
    put(".B dapple {}\n[\\fIOPTION\\fR]...\n.br\n", command->get_name());
  put(".SH DESCRIPTION\n.nf\n{}\n.fi\n", troff(about));
  print_footer(program);
  put(".SH OPTIONS\n");
  for (const CLI::Option* option : shown_options(program)) print_option(*option);
  for (const CLI::App* command : shown_commands(program)) {
    std::string heading = command->get_name();
    std::transform(heading.begin(), heading.end(), heading.begin(), ::toupper);
    put(".SH {}\n{}.\n", heading, troff(command->get_description()));
    for (const CLI::Option* option : shown_options(*command)) print_option(*option);
    print_footer(*command);
  }
  put(".SH SEE ALSO\nThe guide, in /usr/share/doc/dapple or docs/ of the source.\n");
}

void print_bash(const CLI::App& program) {
  put("# bash completion of dapple, made by \"dapple document bash\".\n"
      "_dapple() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} options\n"
      "  case ${{COMP_WORDS[1]}} in\n");
  std::string names;
  for (const CLI::App* command : shown_commands(program)) {
    std::string options;
    for (const CLI::Option* option : shown_options(*command))
      for (const std::string& flag : flags_of(*option)) options += " " + flag;
    put("    {}) options=\"{}\" ;;\n", command->get_name(), options.substr(1));
    names += " " + command->get_name();
  }
  put("    *) options=\"--help --version\" ;;\n  esac\n");
  put("  if [[ $COMP_CWORD -eq 1 && $word != -* ]]; then\n"
      "    options=\"{}\"\n"
      "  elif [[ $word != -* ]]; then\n"
      "    compopt -o filenames 2>/dev/null\n"
      "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
      "    return\n"
      "  fi\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
      "}}\n"
      "complete -F _dapple dapple\n",
      names.substr(1));
}

/// Text within a zsh specification in single quotes.
std::string zsh(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      (out += '\\') += c;
    else
      out += c == '\n' ? ' ' : c;
  }
  return out;
}

void print_zsh(const CLI::App& program) {
  put("#compdef dapple\n# zsh completion of dapple, made by \"dapple document zsh\".\n");
  put("local -a commands=(\n");
  for (const CLI::App* command : shown_commands(program))
    put("  '{}:{}'\n", command->get_name(), zsh(command->get_description()));
  put(")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
      "case $words[2] in\n");
  for (const CLI::App* command : shown_commands(program)) {
    put("  {}) _arguments", command->get_name());
    for (const CLI::Option* option : shown_options(*command))
      for (const std::string& flag : flags_of(*option))
        put(" \\\n    '*{}[{}]{}'", flag, zsh(option->get_description()),
            takes_value(*option) ? fmt::format(":{}:_files", zsh(option->get_type_name())) : "");
    put(" \\\n    '*:file:_files' ;;\n");
  }
  put("esac\n");
}

}  // namespace

Run add_document_command(CLI::App& app) {
  auto kind = std::make_shared<std::string>();
  app.group("");
  app.add_option("KIND", *kind, "man, bash or zsh")->required();
  return [kind, &program = *app.get_parent()] {
    if (*kind == "man") return print_manual(program);
    if (*kind == "bash") return print_bash(program);
    if (*kind == "zsh") return print_zsh(program);
    throw Error(ErrorKind::usage, "dapple document writes man, bash or zsh, not " + *kind);
  };
}

}  // namespace dapple
