#include "points/number_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace dapple {

int NumberTable::find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

bool NumberTable::is_single(std::size_t column) const {
  for (std::size_t i = column; i < values.size(); i += columns)
    if (double{static_cast<float>(values[i])} != values[i] && !std::isnan(values[i])) return false;
  return true;
}

std::string little_endian_rows(const NumberTable& table) {
  std::vector<bool> single(table.columns);
  for (std::size_t c = 0; c < table.columns; ++c) single[c] = table.is_single(c);
  std::string bytes;
  bytes.reserve(table.values.size() * sizeof(double));
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const double value = table.values[i];
    const auto rounded = static_cast<float>(value);
    if (single[i % table.columns])
      bytes.append(reinterpret_cast<const char*>(&rounded), sizeof rounded);
    else
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

}  // namespace dapple
