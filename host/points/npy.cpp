// NPY, versions 1 to 3: little-endian floats and whole numbers, plain or structured; text in
// fields. numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "dapple/error.hpp"
#include "points/number_table.hpp"
#include "scene/message.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

[[noreturn]] void fail_npy(const std::string& path, const std::string& text) {
  throw Error(ErrorKind::input, path + ": " + text);
}

struct Header {
  std::string text;
  std::size_t end = 0;  ///< where the data begin
};

Header read_header(const std::string& path, const std::string& bytes) {
  if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY") != 0)
    fail_npy(path, "is not an NPY file");
  const bool is_long = bytes[6] >= 2;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 8, is_long ? 4 : 2);
  const std::size_t begin = is_long ? 12 : 10;
  if (length > bytes.size() - begin) fail_npy(path, "ends within its header");
  return {bytes.substr(begin, length), begin + length};
}

/// What follows 'key': in the header, a Python dictionary; empty if there is no such key.
std::string_view value_of(std::string_view header, const std::string& key) {
  const std::string quoted = "'" + key + "':";
  const std::size_t at = header.find(quoted);
  if (at == std::string_view::npos) return {};
  header.remove_prefix(at + quoted.size());
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

/// Takes the next 'text' or "text" out of `from`; empty if there is none before `end`.
std::string_view take_quoted(std::string_view& from, char end) {
  const std::size_t open = from.find_first_of("'\"");
  if (open == std::string_view::npos || from.find(end) < open) return {};
  const std::size_t close = from.find(from[open], open + 1);
  if (close == std::string_view::npos) return {};
  const std::string_view text = from.substr(open + 1, close - open - 1);
  from.remove_prefix(close + 1);
  return text;
}

/// The type of a column: NumPy's letter (f, i, u, b; S, U: text), and bytes.
struct ColumnType {
  char kind = 'f';
  std::size_t bytes = 0;
  [[nodiscard]] bool is_text() const { return kind == 'S' || kind == 'U'; }
};

/// The type of a text such as "<f4" or "|S10"; of 0 bytes if it is none of a column.
ColumnType type_of(std::string_view text) {
  if (text.size() < 3 || (text[0] != '<' && text[0] != '|')) return {};
  ColumnType type{text[1], 0};
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), type.bytes);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  if (type.is_text()) {
    constexpr std::size_t kMostLetters = 1u << 20, kBytesOfLetter = 4;
    if (type.bytes > kMostLetters) return {};
    if (type.kind == 'U') type.bytes *= kBytesOfLetter;
    return type;
  }
  const std::string_view sizes = type.kind == 'f'                       ? "48"
                                 : type.kind == 'b'                     ? "1"
                                 : type.kind == 'i' || type.kind == 'u' ? "1248"
                                                                        : "";
  return text.size() == 3 && sizes.find(text[2]) != std::string_view::npos ? type : ColumnType{};
}

template <class T>
double number_of(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

/// A number of a column that is no text.
double number_at(const char* at, ColumnType type) {
  switch (type.kind) {
    case 'f':
      return type.bytes == 4 ? number_of<float>(at) : number_of<double>(at);
    case 'i':
      return type.bytes == 1   ? number_of<std::int8_t>(at)
             : type.bytes == 2 ? number_of<std::int16_t>(at)
             : type.bytes == 4 ? number_of<std::int32_t>(at)
                               : number_of<std::int64_t>(at);
    default:
      return type.bytes == 1   ? number_of<std::uint8_t>(at)
             : type.bytes == 2 ? number_of<std::uint16_t>(at)
             : type.bytes == 4 ? number_of<std::uint32_t>(at)
                               : number_of<std::uint64_t>(at);
  }
}

/// The ASCII letters of a text, others as "?".
std::string text_at(const char* at, ColumnType type) {
  std::string text;
  const std::size_t step = type.kind == 'U' ? 4 : 1;
  for (std::size_t i = 0; i < type.bytes; i += step) {
    std::uint32_t letter = 0;
    std::memcpy(&letter, at + i, step);
    if (letter == 0) break;
    text += letter < ' ' || letter > '~' ? '?' : static_cast<char>(letter);
  }
  return text;
}

/// Throws about a type that cannot be read, such as ">f8". `name`: of the field; empty: no field.
[[noreturn]] void fail_type(const std::string& path, const std::string& name,
                            std::string_view text) {
  std::string after = std::string(text.substr(std::min<std::size_t>(1, text.size())));
  const bool is_swapped = text.starts_with('>') && type_of("<" + after).bytes > 0;
  if (!is_swapped) after = after == "f2" ? "f4" : "";
  if (!name.empty()) after.clear();  // of a field alone NumPy changes no type
  fail_npy(path,
           fmt::format("{} '{}'; it must be little-endian float32, float64 or whole numbers{}",
                       name.empty() ? "its type is" : fmt::format("its field \"{}\" is", name),
                       excerpt(text),
                       after.empty() ? "" : fmt::format(" (numpy: .astype('<{}'))", after)));
}

/// The type of each column, and names of the columns of a structured array.
std::vector<ColumnType> read_types(const std::string& path, std::string_view descr,
                                   std::vector<std::string>& names) {
  std::vector<ColumnType> types;
  const bool structured = descr.starts_with('[');
  do {
    if (structured) {
      if (const std::size_t next = descr.find_first_of("'\"]");
          !types.empty() && (next == std::string_view::npos || descr[next] == ']'))
        return types;
      const std::string_view name = take_quoted(descr, ']');
      if (name.empty())
        fail_npy(path,
                 "has padding between its fields; NumPy removes it: "
                 "numpy.lib.recfunctions.repack_fields(points)");
      names.emplace_back(name);
    }
    const std::string_view text = take_quoted(descr, ']');
    types.push_back(type_of(text));
    if (types.back().bytes == 0 || (!structured && types.back().is_text()))
      fail_type(path, structured ? excerpt(names.back()) : "", text);
    if (structured &&
        !descr.substr(std::min(descr.find_first_not_of(' '), descr.size())).starts_with(')'))
      fail_npy(path, fmt::format("has several values in each \"{}\"; give each a field of its own",
                                 names.back()));
  } while (structured);
  return types;
}

/// The numbers of a tuple, such as (3, 4) or (5,).
std::vector<std::size_t> read_shape(std::string_view text) {
  std::vector<std::size_t> shape;
  text = text.substr(0, text.find(')'));
  while (true) {
    text.remove_prefix(std::min(text.find_first_of("0123456789"), text.size()));
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc()) return shape;
    shape.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

void read_rows(const std::string& path, std::string_view bytes, std::size_t rows,
               const std::vector<ColumnType>& types, NumberTable& table) {
  std::size_t row_bytes = 0;
  for (const ColumnType& type : types) row_bytes += type.bytes;
  if (row_bytes == 0 || rows > bytes.size() / row_bytes)
    fail_npy(path, fmt::format("ends before its {} rows of {} bytes", rows, row_bytes));
  table.values.reserve(rows * types.size());
  const char* at = bytes.data();
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < types.size(); at += types[c++].bytes) {
      if (types[c].is_text())
        table.text.try_emplace(c, TextCell{fmt::format("row {}", r), text_at(at, types[c])});
      table.values.push_back(types[c].is_text() ? std::nan("") : number_at(at, types[c]));
    }
  }
}

}  // namespace

NumberTable read_npy(const std::string& path) {
  const auto raw = read_regular_file(path, path);
  const std::string bytes(reinterpret_cast<const char*>(raw.data()), raw.size());
  const Header header = read_header(path, bytes);
  NumberTable table;
  std::vector<ColumnType> types = read_types(path, value_of(header.text, "descr"), table.names);
  if (value_of(header.text, "fortran_order").starts_with("True"))
    fail_npy(path, "is in Fortran order; save numpy.ascontiguousarray of it");
  const std::vector<std::size_t> shape = read_shape(value_of(header.text, "shape"));
  if (shape.size() != (table.names.empty() ? 2 : 1))
    fail_npy(path,
             fmt::format("has {} dimension{}; it must have rows and columns, or rows of named "
                         "fields",
                         shape.size(), shape.size() == 1 ? "" : "s"));
  constexpr std::size_t kMaxColumns = 1u << 20;
  if (table.names.empty() && shape[1] > kMaxColumns)
    fail_npy(path, fmt::format("has {} columns; there may be {}", shape[1], kMaxColumns));
  if (table.names.empty()) types.assign(shape[1], types[0]);
  table.columns = types.size();
  read_rows(path, std::string_view(bytes).substr(header.end), shape[0], types, table);
  return table;
}

std::string npy_bytes(const NumberTable& table) {
  std::string fields;
  bool is_ascii = true;
  for (std::size_t c = 0; c < table.columns; ++c) {
    fields += fmt::format("('{}', '{}'), ", table.names[c], table.is_single(c) ? "<f4" : "<f8");
    for (const char letter : table.names[c]) is_ascii &= static_cast<unsigned char>(letter) < 128;
  }
  std::string header = fmt::format("{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}",
                                   fields, table.rows());
  header.append(63 - (12 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += is_ascii ? '\x02' : '\x03';  // a header of version 3 is UTF-8
  bytes += '\0';
  const auto length = static_cast<std::uint32_t>(header.size());
  bytes.append(reinterpret_cast<const char*>(&length), 4);
  return bytes + header + little_endian_rows(table);
}

}  // namespace dapple
