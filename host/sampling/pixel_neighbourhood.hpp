// Sums over the 3x3 pixels around each pixel. In: values of pixels, N of each. Out: values and
// sums, pixel by pixel.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstddef>
#include <vector>

namespace dapple {

/// Rows that a thread takes at a time.
inline constexpr int kNeighbourhoodRows = 16;

/// Values of a row of pixels, N of each, as a structure of arrays, so that sums of rows are
/// vectorized. Columns begin at 1; columns 0 and width + 1 are zero.
template <std::size_t N>
class NeighbourhoodRow {
 public:
  explicit NeighbourhoodRow(int width) : stride_(width + 2), values_(N * stride_) {}

  [[nodiscard]] float* kind(std::size_t i) { return values_.data() + i * stride_; }
  [[nodiscard]] const float* kind(std::size_t i) const { return values_.data() + i * stride_; }
  void set(int column, const std::array<float, N>& values) {
    for (std::size_t i = 0; i < N; ++i) kind(i)[column + 1] = values[i];
  }
  [[nodiscard]] std::array<float, N> at(int column) const {
    std::array<float, N> values;
    for (std::size_t i = 0; i < N; ++i) values[i] = kind(i)[column + 1];
    return values;
  }
  /// Sets the values to the sums of the three rows.
  void set_sums(const NeighbourhoodRow& above, const NeighbourhoodRow& own,
                const NeighbourhoodRow& below) {
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = above.values_[i] + own.values_[i] + below.values_[i];
  }
  /// Sets each value to the sum of three adjacent values of `columns`.
  void set_sums_of_three(const NeighbourhoodRow& columns) {
    for (std::size_t i = 0; i < N; ++i) {
      const float* from = columns.kind(i);
      float* to = kind(i);
      for (std::size_t x = 1; x + 1 < stride_; ++x) to[x] = from[x] + from[x - 1] + from[x + 1];
    }
  }
  void swap(NeighbourhoodRow& other) { values_.swap(other.values_); }

 private:
  std::size_t stride_;
  std::vector<float> values_;
};

/// Calls `visit` with the indices of a pixel and its up to eight neighbours.
template <class Visit>
void for_each_neighbour(std::size_t pixel, std::size_t pixels, int width, const Visit& visit) {
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t x = pixel % columns, y = pixel / columns;
  for (std::size_t row = y - (y > 0); row <= y + 1 && row < pixels / columns; ++row)
    for (std::size_t column = x - (x > 0); column <= x + 1 && column < columns; ++column)
      visit(row * columns + column);
}

/// Calls `take` for each of `pixels` pixels, `width` per row, with its index, its values, and the
/// sums of the values over it and its up to eight neighbours. `value` returns a pixel's
/// std::array<float, N>, and is called up to three times per pixel. Memory is needed for a few rows
/// only.
template <class Value, class Take>
void visit_neighbourhoods(std::size_t pixels, int width, const Value& value, const Take& take) {
  using Values = decltype(value(std::size_t{}));
  using Row = NeighbourhoodRow<std::tuple_size_v<Values>>;
  const int height = static_cast<int>(pixels) / width;
  const auto fill = [&](int y, Row& row) {
    for (int x = 0; x < width; ++x)
      row.set(x, y < 0 || y >= height ? Values{} : value(static_cast<std::size_t>(y) * width + x));
  };
  using Range = tbb::blocked_range<int>;
  tbb::parallel_for(Range(0, height, kNeighbourhoodRows), [&](const Range& rows) {
    Row above(width), own(width), below(width), columns(width), around(width);
    fill(rows.begin() - 1, above);
    fill(rows.begin(), own);
    for (int y = rows.begin(); y < rows.end(); ++y) {
      fill(y + 1, below);
      columns.set_sums(above, own, below);
      around.set_sums_of_three(columns);
      for (int x = 0; x < width; ++x)
        take(static_cast<std::size_t>(y) * width + x, own.at(x), around.at(x));
      above.swap(own);
      own.swap(below);
    }
  });
}

}  // namespace dapple
