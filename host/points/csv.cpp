// CSV: a line of names, if it does not begin with a number, then a line a row.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "dapple/error.hpp"
#include "points/number_table.hpp"
#include "scene/gltf/file.hpp"

namespace dapple {
namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  const bool spaced = line.find_first_of(",;\t") == std::string_view::npos;
  const char* separators = spaced ? " " : ",;\t";
  while (true) {
    const std::size_t end = line.find_first_of(separators);
    std::string_view cell = line.substr(0, end);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '"')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '"' || cell.back() == '\r'))
      cell.remove_suffix(1);
    if (!cell.empty() || !spaced) cells.push_back(cell);
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
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

}  // namespace

NumberTable read_csv(const std::string& path) {
  const auto bytes = gltf::read_file(path, path);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  // Files of old Macs end lines with carriage returns alone.
  const char line_end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  NumberTable table;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find(line_end), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos || line.front() == '#') continue;
    check_separators(path, number, line);
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.empty())
      throw Error(ErrorKind::input, fmt::format("{}: line {} has no columns", path, number));
    double value = 0;
    if (table.columns == 0) {
      table.columns = cells.size();
      if (!parse(cells[0], value)) {
        table.names.assign(cells.begin(), cells.end());
        continue;
      }
    }
    if (cells.size() != table.columns)
      throw Error(ErrorKind::input, fmt::format("{}: line {} has {} columns, the first one has {}",
                                                path, number, cells.size(), table.columns));
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool is_number = parse(cells[c], value);
      table.values.push_back(is_number ? value : std::numeric_limits<double>::quiet_NaN());
      if (!is_number && !cells[c].empty())
        table.text.try_emplace(c, TextCell{fmt::format("line {}", number), std::string(cells[c])});
    }
  }
  if (table.columns == 0) throw Error(ErrorKind::input, path + ": there are no rows");
  return table;
}

std::string csv_bytes(const NumberTable& table) {
  std::string text;
  for (std::size_t c = 0; c < table.columns; ++c) text += (c > 0 ? "," : "") + table.names[c];
  text += '\n';
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const double value = table.values[i];
    const auto single = static_cast<float>(value);
    double{single} == value ? fmt::format_to(out, "{}", single) : fmt::format_to(out, "{}", value);
    text += (i + 1) % table.columns == 0 ? '\n' : ',';
  }
  return text;
}

}  // namespace dapple
