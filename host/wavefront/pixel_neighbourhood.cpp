#include "wavefront/pixel_neighbourhood.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace dapple {
namespace {

/// Row `y` of `pixels` and the rows beside it, added up.
void add_rows(const std::vector<float>& pixels, int width, int y, std::vector<float>& sums) {
  const int height = static_cast<int>(pixels.size()) / width;
  std::fill(sums.begin(), sums.end(), 0.0f);
  for (int row = std::max(0, y - 1); row <= std::min(height - 1, y + 1); ++row) {
    const float* values = pixels.data() + static_cast<std::size_t>(row) * width;
    for (int x = 0; x < width; ++x) sums[x] += values[x];
  }
}

}  // namespace

std::vector<float> neighbourhood_sums(const std::vector<float>& pixels, int width) {
  std::vector<float> out(pixels.size());
  tbb::parallel_for(0, static_cast<int>(pixels.size()) / width, [&](int y) {
    std::vector<float> rows(width);
    add_rows(pixels, width, y, rows);
    float* sums = out.data() + static_cast<std::size_t>(y) * width;
    for (int x = 0; x < width; ++x)
      sums[x] = rows[x] + (x > 0 ? rows[x - 1] : 0.0f) + (x + 1 < width ? rows[x + 1] : 0.0f);
  });
  return out;
}

}  // namespace dapple
