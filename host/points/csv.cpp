// CSV: a line of names, if it does not begin with a number, then a line a row. Fields may be quoted
// (RFC 4180) but end on their line.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "dapple/error.hpp"
#include "points/number_table.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

std::string_view trimmed(std::string_view cell) {
  cell.remove_prefix(std::min(cell.find_first_not_of(' '), cell.size()));
  return cell.substr(0, cell.find_last_not_of(" \r") + 1);
}

/// The line with '_' in place of what is between quotes, so that all its separators separate. A
/// quote opens where a field begins; inside, two quotes are one character.
std::string without_quoted(const std::string& path, std::size_t number, std::string_view line) {
  std::string text(line);
  if (line.find('"') == std::string_view::npos) return text;
  bool inside = false, begins = true, separated = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '"') {
      const bool separates = std::string_view(",;\t").find(text[i]) != std::string_view::npos;
      separated = separated || (separates && !inside);
      begins = !inside && (separates || (text[i] == ' ' && (begins || !separated)));
      text[i] = inside ? '_' : text[i];
    } else if (!inside)
      inside = begins;
    else if (i + 1 < text.size() && text[i + 1] == '"')
      text[++i] = '_';
    else
      inside = false;
  }
  if (inside)
    throw Error(ErrorKind::input,
                fmt::format("{}: line {} has a quote that is not closed; a field must end on its "
                            "line, and quotes inside of it are doubled",
                            path, number));
  return text;
}

/// The fields of a line without the quotes around them. `unquoted` is its without_quoted().
std::vector<std::string_view> cells_of(std::string_view line, std::string_view unquoted) {
  std::vector<std::string_view> cells;
  const bool spaced = unquoted.find_first_of(",;\t") == std::string_view::npos;
  const char* separators = spaced ? " " : ",;\t";
  for (std::size_t begin = 0, end = 0;; begin = end + 1) {
    end = std::min(unquoted.find_first_of(separators, begin), line.size());
    std::string_view cell = trimmed(line.substr(begin, end - begin));
    const bool is_field = !spaced || !cell.empty();
    if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"')
      cell = trimmed(cell.substr(1, cell.size() - 2));
    if (is_field) cells.push_back(cell);
    if (end == line.size()) return cells;
  }
}

/// A field with one quote for each two.
std::string text_of(std::string_view cell) {
  std::string text(cell);
  for (std::size_t at = 0; (at = text.find("\"\"", at)) != std::string::npos; ++at)
    text.erase(at, 1);
  return text;
}

/// Throws if columns are separated in two ways, as those of numbers with decimal commas may seem.
void check_separators(const std::string& path, std::size_t number, std::string_view line) {
  std::string found;
  for (const auto& [separator, name] :
       {std::pair{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}})
    if (line.find(separator) != std::string_view::npos)
      found += found.empty() ? name : fmt::format(" and {}", name);
  if (found.find(' ') != std::string::npos)
    throw Error(ErrorKind::input,
                fmt::format("{}: line {} has {}; columns need one separator, and numbers a decimal "
                            "point",
                            path, number, found));
}

bool parse(std::string_view cell, double& value) {
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size();
}

/// Appends the digits that a file of float32 or float64 had: whole numbers in full, others the
/// shortest that give the float32, or else the float64.
void append_digits(double value, std::string& text) {
  constexpr double kMostWhole = 9007199254740992.0;  // 2^53
  // Multiples of this have few digits, and float32 may need fewer than they had: 2097152.25.
  constexpr double kParts = 1024;
  const auto single = static_cast<float>(value);
  const auto out = std::back_inserter(text);
  if (std::trunc(value) == value && std::abs(value) <= kMostWhole)
    fmt::format_to(out, "{:.0f}", value);
  else if (double{single} == value && std::trunc(value * kParts) != value * kParts)
    fmt::format_to(out, "{}", single);
  else
    fmt::format_to(out, "{}", value);
}

/// The names in a comment before rows of `columns` fields, as numpy.savetxt() writes them; empty if
/// it has none that dapple reads.
std::vector<std::string> names_in(std::string_view comment, std::size_t columns) {
  comment.remove_prefix(std::min(comment.find_first_not_of("# "), comment.size()));
  if (comment.find('"') != std::string_view::npos) return {};
  const std::vector<std::string_view> cells = cells_of(comment, comment);
  const bool is_known =
      std::ranges::count(cells, "x") == 1 || std::ranges::count(cells, "azimuth") == 1;
  if (!is_known || cells.size() != columns) return {};
  return {cells.begin(), cells.end()};
}

}  // namespace

NumberTable read_csv(const std::string& path) {
  const auto bytes = read_regular_file(path, path);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  // Files of old Macs end lines with carriage returns alone.
  const char line_end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  NumberTable table;
  std::string_view comment;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find(line_end), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (line.front() == '#') {
      comment = line;
      continue;
    }
    const std::string unquoted = without_quoted(path, number, line);
    check_separators(path, number, unquoted);
    const std::vector<std::string_view> cells = cells_of(line, unquoted);
    if (cells.size() == 1 && cells[0].empty())
      throw Error(ErrorKind::input, fmt::format("{}: line {} has no columns", path, number));
    double value = 0;
    if (table.columns == 0) {
      table.columns = cells.size();
      if (!parse(cells[0], value)) {
        for (const std::string_view name : cells) table.names.push_back(text_of(name));
        continue;
      }
      table.names = names_in(comment, table.columns);
    }
    if (cells.size() != table.columns)
      throw Error(ErrorKind::input, fmt::format("{}: line {} has {} columns, the first one has {}",
                                                path, number, cells.size(), table.columns));
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool is_number = parse(cells[c], value);
      table.values.push_back(is_number ? value : std::numeric_limits<double>::quiet_NaN());
      if (cells[c].empty())
        table.empty.try_emplace(c, table.lines.size());
      else if (!is_number)
        table.text.try_emplace(c, TextCell{fmt::format("line {}", number), text_of(cells[c])});
    }
    table.lines.push_back(number);
  }
  if (table.columns == 0) throw Error(ErrorKind::input, path + ": there are no rows");
  return table;
}

std::string csv_bytes(const NumberTable& table) {
  std::string text;
  for (std::size_t c = 0; c < table.columns; ++c) text += (c > 0 ? "," : "") + table.names[c];
  text += '\n';
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    append_digits(table.values[i], text);
    text += (i + 1) % table.columns == 0 ? '\n' : ',';
  }
  return text;
}

}  // namespace dapple
