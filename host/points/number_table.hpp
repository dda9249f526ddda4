// Tables of numbers with named columns, as CSV, NPY and PLY files hold them.
#pragma once

#include <string>
#include <vector>

namespace dapple {

struct NumberTable {
  std::vector<std::string> names;  ///< of the columns; empty: not said
  std::size_t columns = 0;
  std::vector<double> values;  ///< row after row

  [[nodiscard]] std::size_t rows() const { return columns > 0 ? values.size() / columns : 0; }
  /// The index of a column; -1: none.
  [[nodiscard]] int find(const std::string& name) const;
};

/// Each throws Error input, "PATH: ...".
NumberTable read_csv(const std::string& path);
NumberTable read_npy(const std::string& path);
NumberTable read_ply(const std::string& path);

/// The file's bytes.
std::string csv_bytes(const NumberTable& table);
std::string npy_bytes(const NumberTable& table);
std::string ply_bytes(const NumberTable& table);

}  // namespace dapple
