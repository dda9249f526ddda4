// NPY, versions 1 to 3: little-endian float32 and float64, plain or structured.
// numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "dapple/error.hpp"
#include "points/number_table.hpp"
#include "scene/gltf/file.hpp"

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

/// Takes the next 'text' out of `from`; empty if there is none before `end`.
std::string_view take_quoted(std::string_view& from, char end) {
  const std::size_t open = from.find('\'');
  if (open == std::string_view::npos || from.find(end) < open) return {};
  const std::size_t close = from.find('\'', open + 1);
  if (close == std::string_view::npos) return {};
  const std::string_view text = from.substr(open + 1, close - open - 1);
  from.remove_prefix(close + 1);
  return text;
}

/// Bytes of a little-endian float, 0 for other types.
std::size_t float_bytes(std::string_view type) { return type == "<f4" ? 4 : type == "<f8" ? 8 : 0; }

/// Bytes of each column, and names of the columns of a structured array.
void read_types(const std::string& path, std::string_view descr, NumberTable& table,
                std::vector<std::size_t>& sizes) {
  const bool structured = descr.starts_with('[');
  do {
    if (structured) {
      const std::string_view name = take_quoted(descr, ']');
      if (name.empty() && !sizes.empty()) return;
      table.names.emplace_back(name);
    }
    sizes.push_back(float_bytes(take_quoted(descr, ']')));
    if (sizes.back() == 0)
      fail_npy(path, "must hold little-endian float32 or float64, plain or as named fields");
  } while (structured);
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

}  // namespace

NumberTable read_npy(const std::string& path) {
  const auto raw = gltf::read_file(path, path);
  const std::string bytes(reinterpret_cast<const char*>(raw.data()), raw.size());
  const Header header = read_header(path, bytes);
  NumberTable table;
  std::vector<std::size_t> sizes;
  read_types(path, value_of(header.text, "descr"), table, sizes);
  if (value_of(header.text, "fortran_order").starts_with("True"))
    fail_npy(path, "is in Fortran order; save numpy.ascontiguousarray of it");
  const std::vector<std::size_t> shape = read_shape(value_of(header.text, "shape"));
  if (shape.size() != (table.names.empty() ? 2 : 1))
    fail_npy(path,
             fmt::format("has {} dimension{}; it must have rows and columns, or rows of named "
                         "fields",
                         shape.size(), shape.size() == 1 ? "" : "s"));
  const std::size_t rows = shape[0];
  constexpr std::size_t kMaxColumns = 1u << 20;
  if (table.names.empty()) sizes.assign(std::min(shape[1], kMaxColumns), sizes[0]);
  table.columns = sizes.size();
  std::size_t row_bytes = 0;
  for (const std::size_t size : sizes) row_bytes += size;
  if (row_bytes == 0 || rows > (bytes.size() - header.end) / row_bytes)
    fail_npy(path, fmt::format("ends before its {} rows of {} bytes", rows, row_bytes));
  table.values.reserve(rows * sizes.size());
  const char* at = bytes.data() + header.end;
  for (std::size_t r = 0; r < rows; ++r) {
    for (const std::size_t size : sizes) {
      float single = 0;
      double value = 0;
      std::memcpy(size == 4 ? static_cast<void*>(&single) : &value, at, size);
      table.values.push_back(size == 4 ? double{single} : value);
      at += size;
    }
  }
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
