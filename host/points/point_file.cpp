#include "points/point_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "points/number_table.hpp"
#include "scene/check/numeric_range.hpp"
#include "scene/message.hpp"

namespace dapple {
namespace {

constexpr const char* kPointNames[] = {"x", "y", "z", "nx", "ny", "nz"};
constexpr const char* kSunNames[] = {"azimuth", "elevation", "irradiance", "x", "y", "z"};

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string ending(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

/// How tables of numbers are read and written.
struct TableFormat {
  std::string_view ending;
  NumberTable (*read)(const std::string& path);
  std::string (*bytes)(const NumberTable& table);
};

constexpr TableFormat kFormats[] = {
    {".csv", read_csv, csv_bytes}, {".npy", read_npy, npy_bytes}, {".ply", read_ply, ply_bytes}};

/// By the ending of `path`. Throws Error usage: points are `done` other files.
const TableFormat& format_of(const std::string& path, const char* done) {
  const auto* found = std::ranges::find(kFormats, ending(path), &TableFormat::ending);
  if (found == std::end(kFormats)) {
    std::vector<std::string_view> endings;
    for (const TableFormat& format : kFormats) endings.emplace_back(format.ending);
    throw Error(ErrorKind::usage, fmt::format("{}: points are {} files of these: {}", path, done,
                                              fmt::join(endings, ", ")));
  }
  return *found;
}

NumberTable read_table(const std::string& path) { return format_of(path, "read from").read(path); }

/// Cells that must be numbers. Errors name the file, the line or row, and the column.
class NumberCells {
 public:
  NumberCells(const std::string& path, const NumberTable& table) : path_(path), table_(table) {}

  [[noreturn]] void fail(std::size_t row, const std::string& what) const {
    const std::string place = table_.lines.empty() ? fmt::format("row {}", row)
                                                   : fmt::format("line {}", table_.lines[row]);
    throw Error(ErrorKind::input, fmt::format("{}: {}: {}", path_, place, what));
  }
  /// Throws if a cell of the column is text.
  void check(int column, const char* name) const {
    const auto found = table_.text.find(static_cast<std::size_t>(column));
    if (found != table_.text.end())
      throw Error(ErrorKind::input, fmt::format("{}: {}: {} is \"{}\"; it must be a number", path_,
                                                found->second.place, name, found->second.text));
  }
  [[nodiscard]] double finite(std::size_t row, int at, const char* name) const {
    const auto column = static_cast<std::size_t>(at);
    const double value = table_.values[row * table_.columns + column];
    if (std::isfinite(value)) return value;
    const auto empty = table_.empty.find(column);
    if (empty != table_.empty.end() && empty->second == row)
      fail(row, fmt::format("{} is empty; it must be a number", name));
    fail(row, fmt::format("{} is {}; it must be a finite number", name, value));
  }

 private:
  const std::string& path_;
  const NumberTable& table_;
};

/// Three columns as vectors, at `first` or by their names.
class VectorColumns {
 public:
  VectorColumns(const NumberTable& table, const char* const (&names)[3], std::size_t first) {
    for (std::size_t k = 0; k < 3; ++k) {
      names_[k] = names[k];
      const int named = table.find(names[k]);
      column_[k] = table.names.empty() ? static_cast<int>(first + k) : named;
      exists_ = exists_ && column_[k] >= 0 && static_cast<std::size_t>(column_[k]) < table.columns;
    }
  }
  [[nodiscard]] bool exist() const { return exists_; }
  [[nodiscard]] bool include(std::size_t column) const {
    return exists_ && std::ranges::count(column_, static_cast<int>(column)) > 0;
  }
  void check(const NumberCells& cells) const {
    for (std::size_t k = 0; k < 3 && exists_; ++k) cells.check(column_[k], names_[k]);
  }
  [[nodiscard]] V3d at(const NumberCells& cells, std::size_t row) const {
    const auto value = [&](std::size_t k) { return cells.finite(row, column_[k], names_[k]); };
    return {value(0), value(1), value(2)};
  }

 private:
  const char* names_[3] = {};
  int column_[3] = {-1, -1, -1};
  bool exists_ = true;
};

/// In lower case and without a unit in brackets: "azimuth" of "Azimuth [deg]".
std::string plain_name(const std::string& name) {
  const std::string letters = name.substr(0, name.find_first_of("[("));
  return lower_case(letters.substr(0, letters.find_last_not_of(' ') + 1));
}

/// Throws with the names that the file has. `need`: what it must have, of `wanted`.
[[noreturn]] void fail_names(const std::string& path, const NumberTable& table,
                             const std::string& need, std::span<const char* const> wanted) {
  const bool is_near = std::ranges::any_of(table.names, [&](const std::string& name) {
    return std::ranges::count(wanted, name) == 0 &&
           std::ranges::count(wanted, plain_name(name)) > 0;
  });
  throw Error(ErrorKind::input,
              one_line(fmt::format("{}: needs {}; it has {}{}", path, need,
                                   table.names.empty()
                                       ? fmt::format("{} column{} without names", table.columns,
                                                     table.columns == 1 ? "" : "s")
                                       : excerpt(fmt::format("{}", fmt::join(table.names, ", "))),
                                   is_near ? "; names are lower case, without units" : "")));
}

/// Whether all bytes belong to characters of UTF-8 (RFC 3629; surrogates are not looked for).
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int more = first < 0x80 ? 0 : std::countl_one(first) - 1;
    if (first >= 0x80 && (first < 0xc2 || first > 0xf4)) return false;
    for (int k = 0; k < more; ++k)
      if (++i == text.size() || (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return false;
  }
  return true;
}

/// A name that every format can hold: without separators, quotes and control characters, in UTF-8,
/// and unlike the names before it and those of positions and normals.
std::string column_name(const NumberTable& table, std::size_t column, const PointList& list) {
  std::string name = column < table.names.size() ? table.names[column] : "";
  const bool is_text = is_utf8(name);
  for (char& letter : name)
    if (static_cast<unsigned char>(letter) <= ' ' ||
        (!is_text && static_cast<unsigned char>(letter) >= 0x80) ||
        std::string_view(",;\"'\\\x7f").find(letter) != std::string_view::npos)
      letter = '_';
  const auto is_taken = [&](const std::string& wanted) {
    return std::ranges::count(list.extra, wanted, &ExtraColumn::name) > 0 ||
           std::ranges::count(kPointNames, wanted) > 0;
  };
  if (!name.empty() && !is_taken(name)) return name;
  for (std::size_t number = column + 1;; ++number) {
    name = fmt::format("column_{}", number);
    if (!is_taken(name) && std::ranges::count(table.names, name) == 0) return name;
  }
}

/// Columns that are neither positions nor normals.
void read_extra(const std::string& path, const NumberTable& table, const VectorColumns& positions,
                const VectorColumns& normals, PointList& list) {
  for (std::size_t c = 0; c < table.columns; ++c) {
    if (positions.include(c) || normals.include(c)) continue;
    ExtraColumn extra{column_name(table, c, list), {}};
    const auto text = table.text.find(c);
    if (text != table.text.end()) {
      list.notes.push_back(
          fmt::format("{}: the column {} holds text (\"{}\" in {}) and is left out", path,
                      extra.name, text->second.text, text->second.place));
      continue;
    }
    for (std::size_t i = c; i < table.values.size(); i += table.columns)
      extra.values.push_back(table.values[i]);
    list.extra.push_back(std::move(extra));
  }
}

/// Throws if there are some of the columns of normals, not all.
void check_normal_names(const std::string& path, const NumberTable& table) {
  const auto named = std::ranges::count_if(std::span(kPointNames).subspan(3),
                                           [&](const char* name) { return table.find(name) >= 0; });
  if (named == 1 || named == 2)
    fail_names(path, table, "all of the columns nx, ny, nz for normals", kPointNames);
}

/// Of length 1, also where the square of its length would be infinite or 0. `v` is finite and not
/// 0.
V3f unit_of(const V3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return V3f((v / largest).normalized());
}

V3f direction_of(double azimuth, double elevation) {
  constexpr double kDegree = std::numbers::pi / 180;
  const double ring = std::cos(elevation * kDegree);
  return {static_cast<float>(ring * std::sin(azimuth * kDegree)),
          static_cast<float>(std::sin(elevation * kDegree)),
          static_cast<float>(-ring * std::cos(azimuth * kDegree))};
}

/// The columns of a file of suns.
struct SunColumns {
  explicit SunColumns(const NumberTable& table)
      : azimuth(table.find("azimuth")),
        elevation(table.find("elevation")),
        irradiance(table.find("irradiance")),
        direction(table, {"x", "y", "z"}, table.columns) {}

  [[nodiscard]] bool are_angles() const { return azimuth >= 0 && elevation >= 0; }
  [[nodiscard]] bool exist() const {
    return irradiance >= 0 && (are_angles() || direction.exist());
  }
  /// Throws if a cell is text.
  void check(const NumberCells& cells) const {
    if (are_angles()) {
      cells.check(azimuth, "azimuth");
      cells.check(elevation, "elevation");
    } else {
      direction.check(cells);
    }
    cells.check(irradiance, "irradiance");
  }

  int azimuth, elevation, irradiance;  ///< -1: none
  VectorColumns direction;             ///< if there are no angles
};

SunDirection sun_at(const NumberCells& cells, std::size_t row, const SunColumns& columns) {
  SunDirection sun;
  if (columns.are_angles()) {
    const double elevation = cells.finite(row, columns.elevation, "elevation");
    if (std::abs(elevation) > 90)
      cells.fail(row, fmt::format("elevation is {}; it must be from -90 to 90 degrees", elevation));
    const double azimuth = cells.finite(row, columns.azimuth, "azimuth");
    sun.direction = unit_of(V3d(direction_of(azimuth, elevation)));
  } else {
    const V3d direction = columns.direction.at(cells, row);
    if (direction == V3d(0.0))
      cells.fail(row, "the direction x, y, z is zero; it must be towards the sun");
    sun.direction = unit_of(direction);
  }
  const double irradiance = cells.finite(row, columns.irradiance, "irradiance");
  constexpr double kMost = std::numeric_limits<float>::max();
  if (irradiance < 0 || irradiance > kMost)
    cells.fail(row, fmt::format("irradiance is {}; it must be {}", irradiance,
                                irradiance < 0 ? "0 or more" : fmt::format("below {:.2g}", kMost)));
  sun.irradiance = static_cast<float>(irradiance);
  return sun;
}

/// Whether no elevation is beyond a quarter turn and no azimuth beyond a turn, in radians. Degrees
/// of all suns at the horizon in the north are not taken for radians: all angles are 0.
bool may_be_radians(const NumberTable& table, const SunColumns& columns) {
  const auto largest = [&](int column) {
    double most = 0;
    for (auto i = static_cast<std::size_t>(column); i < table.values.size(); i += table.columns)
      most = std::max(most, std::abs(table.values[i]));
    return most;
  };
  const double azimuth = largest(columns.azimuth), elevation = largest(columns.elevation);
  return azimuth <= 6.3 && elevation <= 1.6 && (azimuth > 0 || elevation > 0);
}

/// Notes how columns without names are read where there are neither 3 nor 6.
void note_unnamed(const std::string& path, const NumberTable& table, bool has_normals,
                  PointList& list) {
  if (!table.names.empty() || table.columns == (has_normals ? 6u : 3u)) return;
  list.notes.push_back(fmt::format("{}: has {} columns without names; the first are read as {}",
                                   path, table.columns,
                                   has_normals ? "x, y, z, nx, ny, nz" : "x, y, z"));
}

}  // namespace

PointList read_points(const std::string& path) {
  const NumberTable table = read_table(path);
  const VectorColumns positions(table, {"x", "y", "z"}, 0), normals(table, {"nx", "ny", "nz"}, 3);
  PointList list;
  if (table.rows() == 0) {
    list.notes.push_back(path + ": no points");
    return list;
  }
  if (!positions.exist())
    fail_names(path, table,
               table.names.empty() ? "3 columns (x, y, z), or 6 (and nx, ny, nz), or names"
                                   : "the columns x, y, z (and nx, ny, nz)",
               kPointNames);
  check_normal_names(path, table);
  const NumberCells cells(path, table);
  positions.check(cells);
  normals.check(cells);
  note_unnamed(path, table, normals.exist(), list);
  read_extra(path, table, positions, normals, list);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const V3d position = positions.at(cells, row);
    const V3d normal = normals.exist() ? normals.at(cells, row) : V3d(0, 1, 0);
    for (unsigned k = 0; k < 3; ++k)
      if (std::abs(position[k]) > kLargestCoordinate)
        cells.fail(row, fmt::format("{} is {}; it must be within {:g} m of the origin",
                                    kPointNames[k], position[k], kLargestCoordinate));
    if (normal == V3d(0.0)) cells.fail(row, "the normal nx, ny, nz is zero; it must have a length");
    list.points.emplace_back(position);
    list.normals.push_back(unit_of(normal));
  }
  return list;
}

std::vector<SunDirection> read_suns(const std::string& path, std::vector<std::string>* notes) {
  const NumberTable table = read_csv(path);
  const SunColumns columns(table);
  if (!columns.exist())
    fail_names(path, table, "a line of names: azimuth,elevation,irradiance or x,y,z,irradiance",
               kSunNames);
  const NumberCells cells(path, table);
  columns.check(cells);
  if (table.rows() == 0) throw Error(ErrorKind::input, path + ": there are no rows");
  std::vector<SunDirection> suns;
  for (std::size_t row = 0; row < table.rows(); ++row) suns.push_back(sun_at(cells, row, columns));
  if (notes != nullptr && columns.are_angles() && may_be_radians(table, columns))
    notes->push_back(path + ": angles are taken as degrees; these look like radians");
  return suns;
}

void check_point_output(const std::string& path) { format_of(path, "written as"); }

void write_points(const std::string& path, const PointList& list,
                  const std::vector<PointColumn>& results) {
  std::vector<const ExtraColumn*> extra;
  for (const ExtraColumn& column : list.extra)
    if (std::ranges::count(kPointNames, column.name) == 0 &&
        std::ranges::count(results, column.name, &PointColumn::name) == 0)
      extra.push_back(&column);
  NumberTable table;
  table.names.assign(std::begin(kPointNames), std::end(kPointNames));
  for (const ExtraColumn* column : extra) table.names.push_back(column->name);
  for (const PointColumn& column : results) table.names.push_back(column.name);
  table.columns = table.names.size();
  table.values.reserve(table.columns * list.points.size());
  for (std::size_t i = 0; i < list.points.size(); ++i) {
    for (const V3f& v : {list.points[i], list.normals[i]})
      table.values.insert(table.values.end(), {double{v.x}, double{v.y}, double{v.z}});
    for (const ExtraColumn* column : extra) table.values.push_back(column->values[i]);
    for (const PointColumn& column : results) table.values.push_back(double{column.values[i]});
  }
  write_whole_file(path, format_of(path, "written as").bytes(table));
}

}  // namespace dapple
