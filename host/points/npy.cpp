// NPY, versions 1 to 3: little-endian float32 and float64, plain or structured.
// numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <regex>

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

/// Types by column, '4' or '8' bytes, and their names.
void read_types(const std::string& path, const std::string& header, NumberTable& table,
                std::vector<std::size_t>& sizes) {
  std::smatch match;
  if (std::regex_search(header, match, std::regex("'descr': *'([<|=]?)f([48])'"))) {
    sizes.assign(1, match[2] == "4" ? 4 : 8);
    return;
  }
  const std::regex field(R"(\('(\w+)', *'<f([48])'\))");
  for (std::sregex_iterator i(header.begin(), header.end(), field), end; i != end; ++i) {
    table.names.push_back((*i)[1]);
    sizes.push_back((*i)[2] == "4" ? 4 : 8);
  }
  if (sizes.empty())
    fail_npy(path, "must hold little-endian float32 or float64, plain or as named fields");
}

}  // namespace

NumberTable read_npy(const std::string& path) {
  const auto raw = gltf::read_file(path, path);
  const std::string bytes(reinterpret_cast<const char*>(raw.data()), raw.size());
  const Header header = read_header(path, bytes);
  NumberTable table;
  std::vector<std::size_t> sizes;
  read_types(path, header.text, table, sizes);
  if (header.text.find("'fortran_order': True") != std::string::npos)
    fail_npy(path, "is in Fortran order; save numpy.ascontiguousarray of it");
  std::smatch shape;
  if (!std::regex_search(header.text, shape, std::regex(R"('shape': *\((\d+), *(\d*)\))")))
    fail_npy(path, "must have a shape of rows and columns, or rows of named fields");
  const std::size_t rows = std::stoull(shape[1]);
  if (table.names.empty()) {
    if (shape[2].length() == 0) fail_npy(path, "has one dimension; it must have rows and columns");
    sizes.assign(std::stoull(shape[2]), sizes[0]);
  }
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
  for (const std::string& name : table.names) fields += fmt::format("('{}', '<f4'), ", name);
  std::string header = fmt::format("{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}",
                                   fields, table.rows());
  header.append(63 - (12 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes = "\x93NUMPY\x02";
  bytes += '\0';
  const auto length = static_cast<std::uint32_t>(header.size());
  bytes.append(reinterpret_cast<const char*>(&length), 4);
  bytes += header;
  for (const double value : table.values) {
    const auto single = static_cast<float>(value);
    bytes.append(reinterpret_cast<const char*>(&single), 4);
  }
  return bytes;
}

}  // namespace dapple
