// Tables of numbers with named columns, as CSV, NPY and PLY files hold them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace dapple {

/// A cell that is not a number.
struct TextCell {
  std::string place;  ///< "line 2" of a CSV file, "row 0" of an array
  std::string text;
};

struct NumberTable {
  std::vector<std::string> names;  ///< of the columns; empty: not said
  std::size_t columns = 0;
  std::vector<double> values;                  ///< row after row; NaN where a cell is empty or text
  std::map<std::size_t, TextCell> text{};      ///< by column: the first cell that is text
  std::map<std::size_t, std::size_t> empty{};  ///< by column: the row of the first empty cell
  std::vector<std::size_t> lines{};            ///< of rows in a CSV file, from 1; others have none

  [[nodiscard]] std::size_t rows() const { return columns > 0 ? values.size() / columns : 0; }
  /// The index of a column; -1: none.
  [[nodiscard]] int find(const std::string& name) const;
  /// True if float32 holds every value of a column.
  [[nodiscard]] bool is_single(std::size_t column) const;
};

/// Each throws Error input, "PATH: ...".
NumberTable read_csv(const std::string& path);
NumberTable read_npy(const std::string& path);
NumberTable read_ply(const std::string& path);

/// The file's bytes. Columns are float32, or float64 where they need it.
std::string csv_bytes(const NumberTable& table);
std::string npy_bytes(const NumberTable& table);
std::string ply_bytes(const NumberTable& table);

/// The values as NPY and PLY hold them: row after row, each column in its own type.
std::string little_endian_rows(const NumberTable& table);

}  // namespace dapple
