// Sums over the pixels around each pixel.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstddef>
#include <vector>

namespace dapple {

/// Rows that a thread goes through in one go.
inline constexpr int kNeighbourhoodRows = 16;

/// Calls `take` with each of so many pixels, `width` a row: its number, its values and their sums
/// over it and its up to eight neighbours. `value`: a pixel's std::array<float, N>; asked for up to
/// three times. Nothing of the size of a picture is kept.
template <class Value, class Take>
void visit_neighbourhoods(std::size_t pixels, int width, const Value& value, const Take& take) {
  using Values = decltype(value(std::size_t{}));
  const int height = static_cast<int>(pixels) / width;
  const auto fill = [&](int y, std::vector<Values>& row) {
    for (int x = 0; x < width; ++x)
      row[x] = y < 0 || y >= height ? Values{} : value(static_cast<std::size_t>(y) * width + x);
  };
  const auto add = [](Values a, const Values& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    return a;
  };
  using Range = tbb::blocked_range<int>;
  tbb::parallel_for(Range(0, height, kNeighbourhoodRows), [&](const Range& rows) {
    // Columns lie from 1 on, with nothing on either side.
    std::vector<Values> above(width), own(width), below(width), columns(width + 2);
    fill(rows.begin() - 1, above);
    fill(rows.begin(), own);
    for (int y = rows.begin(); y < rows.end(); ++y) {
      fill(y + 1, below);
      for (int x = 0; x < width; ++x) columns[x + 1] = add(add(above[x], own[x]), below[x]);
      for (int x = 0; x < width; ++x)
        take(static_cast<std::size_t>(y) * width + x, own[x],
             add(add(columns[x + 1], columns[x]), columns[x + 2]));
      above.swap(own);
      own.swap(below);
    }
  });
}

}  // namespace dapple
