// PLY: scalar properties of the element vertex, which must be the first element.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>

#include "dapple/error.hpp"
#include "points/number_table.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

[[noreturn]] void fail_ply(const std::string& path, const std::string& text) {
  throw Error(ErrorKind::input, path + ": " + text);
}

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

const std::map<std::string, Type>& types() {
  static const std::map<std::string, Type> known{
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  return known;
}

template <class T>
double take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return static_cast<double>(value);
}

double take(Type type, const char*& at) {
  switch (type) {
    case Type::i8:
      return take<std::int8_t>(at);
    case Type::u8:
      return take<std::uint8_t>(at);
    case Type::i16:
      return take<std::int16_t>(at);
    case Type::u16:
      return take<std::uint16_t>(at);
    case Type::i32:
      return take<std::int32_t>(at);
    case Type::u32:
      return take<std::uint32_t>(at);
    case Type::f32:
      return take<float>(at);
    default:
      return take<double>(at);
  }
}

std::size_t bytes_of(Type type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

struct Header {
  std::size_t rows = 0, end = 0, row_bytes = 0;
  bool ascii = false;
  std::vector<Type> types;
};

/// A vertex takes a byte at least, so the file's size limits their number.
std::size_t vertex_count(const std::string& path, const std::string& text, std::size_t file_bytes) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error == std::errc::invalid_argument || end != text.data() + text.size())
    fail_ply(path, fmt::format("its number of vertices is '{}'; it must be a whole number", text));
  if (error != std::errc() || count > file_bytes)
    fail_ply(path, fmt::format("ends before its {} vertices", text));
  return count;
}

/// Where the line end_header begins, which ends with a line feed or a carriage return and one;
/// npos: nowhere.
std::size_t end_of_header(const std::string& bytes) {
  for (std::size_t at = 0; at != std::string::npos;) {
    at = bytes.find("\nend_header", at);
    if (at == std::string::npos) break;
    const std::size_t after = at + 11;
    const std::size_t line_end = after + (after < bytes.size() && bytes[after] == '\r' ? 1 : 0);
    if (line_end < bytes.size() && bytes[line_end] == '\n') return at + 1;
    at = after;
  }
  return std::string::npos;
}

Header read_header(const std::string& path, const std::string& bytes, NumberTable& table) {
  const std::size_t end = end_of_header(bytes);
  if (bytes.compare(0, 3, "ply") != 0 || end == std::string::npos)
    fail_ply(path, "is not a PLY file: it must begin with a line ply, and have a line end_header");
  Header header;
  std::istringstream lines(bytes.substr(0, end));
  std::string line, element;
  bool has_format = false;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word >> type >> name;
    if (word == "format") {
      has_format = true;
      header.ascii = type == "ascii";
      if (!header.ascii && type != "binary_little_endian")
        fail_ply(path, "is " + type + "; it must be ascii or binary_little_endian");
    } else if (word == "element") {
      if (element.empty() && type != "vertex") fail_ply(path, "vertex must be its first element");
      if (element.empty()) header.rows = vertex_count(path, name, bytes.size());
      element = type;
    } else if (word == "property" && element == "vertex") {
      const auto found = types().find(type);
      if (found == types().end()) fail_ply(path, "vertex has a property of type " + type);
      header.types.push_back(found->second);
      header.row_bytes += bytes_of(found->second);
      table.names.push_back(name);
    }
  }
  if (!has_format)
    fail_ply(path,
             "has no line format, such as 'format ascii 1.0' or 'format "
             "binary_little_endian 1.0'");
  header.end = bytes.find('\n', end) + 1;
  table.columns = table.names.size();
  return header;
}

/// The next line that is not empty, without its end.
std::string_view take_line(std::string_view& rest) {
  std::string_view line;
  while (line.empty() && !rest.empty()) {
    line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
  }
  return line;
}

/// Reads a vertex, which has a line of its own.
void read_line(const std::string& path, std::size_t row, std::string_view line,
               NumberTable& table) {
  const char *at = line.data(), *const end = line.data() + line.size();
  const auto is_space = [&] { return at < end && (*at == ' ' || *at == '\t'); };
  for (std::size_t column = 0; column < table.columns; ++column) {
    while (is_space()) ++at;
    if (at < end && *at == '+') ++at;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    at = next;
    if (error != std::errc() || (at < end && !is_space()))
      fail_ply(path, fmt::format("vertex {}: its line must have {} numbers, one is missing or "
                                 "not a number",
                                 row, table.columns));
    table.values.push_back(value);
  }
  if (at != end)
    fail_ply(path, fmt::format("vertex {}: its line has more than {} numbers", row, table.columns));
}

}  // namespace

NumberTable read_ply(const std::string& path) {
  const auto raw = read_regular_file(path, path);
  const std::string bytes(reinterpret_cast<const char*>(raw.data()), raw.size());
  NumberTable table;
  const Header header = read_header(path, bytes, table);
  if (header.ascii) {
    std::string_view rest = std::string_view(bytes).substr(header.end);
    for (std::size_t row = 0; row < header.rows; ++row)
      read_line(path, row, take_line(rest), table);
    return table;
  }
  if (header.row_bytes == 0 || header.rows > (bytes.size() - header.end) / header.row_bytes)
    fail_ply(path, fmt::format("ends before its {} vertices", header.rows));
  const char* at = bytes.data() + header.end;
  for (std::size_t r = 0; r < header.rows; ++r)
    for (const Type type : header.types) table.values.push_back(take(type, at));
  return table;
}

std::string ply_bytes(const NumberTable& table) {
  std::string bytes =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", table.rows());
  for (std::size_t c = 0; c < table.columns; ++c)
    bytes +=
        fmt::format("property {} {}\n", table.is_single(c) ? "float" : "double", table.names[c]);
  return bytes + "end_header\n" + little_endian_rows(table);
}

}  // namespace dapple
