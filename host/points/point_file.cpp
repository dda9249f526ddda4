#include "points/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "points/number_table.hpp"
#include "scene/numeric_range.hpp"

namespace dapple {
namespace {

constexpr const char* kPointNames[] = {"x", "y", "z", "nx", "ny", "nz"};

std::string ending(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

NumberTable read_table(const std::string& path) {
  if (ending(path) == ".csv") return read_csv(path);
  if (ending(path) == ".npy") return read_npy(path);
  if (ending(path) == ".ply") return read_ply(path);
  throw Error(ErrorKind::usage, path + ": points are read from .csv, .npy and .ply");
}

/// Three columns as vectors, at `first` or by their names.
class VectorColumns {
 public:
  VectorColumns(const NumberTable& table, const char* const (&names)[3], std::size_t first)
      : table_(table) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int named = table.find(names[k]);
      column_[k] = table.names.empty() ? static_cast<int>(first + k) : named;
      exists_ = exists_ && column_[k] >= 0 && static_cast<std::size_t>(column_[k]) < table.columns;
    }
  }
  [[nodiscard]] bool exist() const { return exists_; }
  [[nodiscard]] bool include(std::size_t column) const {
    return exists_ && std::ranges::count(column_, static_cast<int>(column)) > 0;
  }
  [[nodiscard]] V3d at(std::size_t row) const {
    const auto value = [&](std::size_t k) {
      return table_.values[row * table_.columns + static_cast<std::size_t>(column_[k])];
    };
    return {value(0), value(1), value(2)};
  }

 private:
  const NumberTable& table_;
  int column_[3] = {-1, -1, -1};
  bool exists_ = true;
};

/// Throws if the column must hold numbers and does not.
void check_number(const std::string& path, const NumberTable& table, std::size_t column) {
  const auto found = table.text.find(column);
  if (found != table.text.end())
    throw Error(ErrorKind::input, fmt::format("{}: {}: \"{}\" is not a number", path,
                                              found->second.place, found->second.text));
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
    throw Error(ErrorKind::input, path + ": normals need all of the columns nx, ny, nz");
}

void check_finite(const std::string& path, std::size_t row, const V3d& value) {
  if (std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z)) return;
  throw Error(ErrorKind::input,
              fmt::format("{}: row {} has a number that is not finite", path, row));
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

}  // namespace

PointList read_points(const std::string& path) {
  const NumberTable table = read_table(path);
  const VectorColumns positions(table, {"x", "y", "z"}, 0), normals(table, {"nx", "ny", "nz"}, 3);
  PointList list;
  if (table.rows() == 0) return list;
  if (!positions.exist())
    throw Error(ErrorKind::input, path + ": needs the columns x, y, z (and nx, ny, nz)");
  check_normal_names(path, table);
  for (std::size_t c = 0; c < table.columns; ++c)
    if (positions.include(c) || normals.include(c)) check_number(path, table, c);
  read_extra(path, table, positions, normals, list);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const V3d position = positions.at(row);
    const V3d normal = normals.exist() ? normals.at(row) : V3d(0, 1, 0);
    check_finite(path, row, position);
    check_finite(path, row, normal);
    if (std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}) >
        kLargestCoordinate)
      throw Error(ErrorKind::input, fmt::format("{}: row {} is more than {:g} m from the origin",
                                                path, row, kLargestCoordinate));
    if (normal == V3d(0.0))
      throw Error(ErrorKind::input, fmt::format("{}: the normal of row {} is zero", path, row));
    list.points.emplace_back(position);
    list.normals.push_back(unit_of(normal));
  }
  return list;
}

std::vector<SunDirection> read_suns(const std::string& path) {
  const NumberTable table = read_csv(path);
  const VectorColumns directions(table, {"x", "y", "z"}, table.columns);
  const int azimuth = table.find("azimuth"), elevation = table.find("elevation"),
            irradiance = table.find("irradiance");
  const bool angles = azimuth >= 0 && elevation >= 0;
  if (irradiance < 0 || !(angles || directions.exist()))
    throw Error(ErrorKind::input,
                path + ": needs a line of names: azimuth,elevation,irradiance or x,y,z,irradiance");
  for (std::size_t c = 0; c < table.columns; ++c) {
    const bool is_angle = angles && (std::cmp_equal(c, azimuth) || std::cmp_equal(c, elevation));
    if (std::cmp_equal(c, irradiance) || is_angle || (!angles && directions.include(c)))
      check_number(path, table, c);
  }
  if (table.rows() == 0) throw Error(ErrorKind::input, path + ": there are no rows");
  std::vector<SunDirection> suns;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double* values = &table.values[row * table.columns];
    SunDirection sun;
    sun.irradiance = static_cast<float>(values[irradiance]);
    if (angles && std::abs(values[elevation]) > 90)
      throw Error(ErrorKind::input,
                  fmt::format("{}: row {} has an elevation of {}; it must be from "
                              "-90 to 90 degrees",
                              path, row, values[elevation]));
    const V3d given =
        angles ? V3d(direction_of(values[azimuth], values[elevation])) : directions.at(row);
    check_finite(path, row, given);
    if (given == V3d(0.0) || !(sun.irradiance >= 0) || !std::isfinite(sun.irradiance))
      throw Error(ErrorKind::input,
                  fmt::format("{}: row {} is not a direction with an irradiance", path, row));
    sun.direction = unit_of(given);
    suns.push_back(sun);
  }
  return suns;
}

void check_point_output(const std::string& path) {
  for (const char* type : {".csv", ".npy", ".ply"})
    if (ending(path) == type) return;
  throw Error(ErrorKind::usage, path + ": points are written as .csv, .npy or .ply");
}

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
  check_point_output(path);
  const std::string type = ending(path);
  write_whole_file(path, type == ".csv"   ? csv_bytes(table)
                         : type == ".npy" ? npy_bytes(table)
                                          : ply_bytes(table));
}

}  // namespace dapple
