#include "compare/worst_window.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace dapple {
namespace {

/// sum(x, y) is the sum of all values in the columns before x and the rows before y.
class SummedArea {
 public:
  SummedArea(std::vector<double> values, int width, int height)
      : values_(std::move(values)), width_(static_cast<std::size_t>(width)) {
    for (int y = 0; y < height; ++y) {
      double row = 0.0;
      for (int x = 0; x < width; ++x) {
        double& value = values_[index(x, y)];
        row += value;
        value = row + sum(x + 1, y);
      }
    }
  }

  [[nodiscard]] double sum(int x, int y) const {
    return x == 0 || y == 0 ? 0.0 : values_[index(x - 1, y - 1)];
  }
  [[nodiscard]] double sum(const PixelRect& r) const {
    return sum(r.x1 + 1, r.y1 + 1) - sum(r.x0, r.y1 + 1) - sum(r.x1 + 1, r.y0) + sum(r.x0, r.y0);
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
  }

  std::vector<double> values_;  // turned into inclusive sums in place, since pictures can be large
  std::size_t width_;
};

}  // namespace

WorstWindow find_worst_window(std::vector<double> squared, int width, int height) {
  assert(squared.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const SummedArea table(std::move(squared), width, height);
  const int side_x = std::min(kWindowSide, width);
  const int side_y = std::min(kWindowSide, height);
  WorstWindow worst{{0, 0, side_x - 1, side_y - 1}, 0.0};
  for (int y = 0; y + side_y <= height; ++y) {
    for (int x = 0; x + side_x <= width; ++x) {
      const PixelRect rect{x, y, x + side_x - 1, y + side_y - 1};
      const double sum = table.sum(rect);
      if (sum > worst.sum) worst = {rect, sum};
    }
  }
  return worst;
}

}  // namespace dapple
