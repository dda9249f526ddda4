#include "film/back_sources.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace dapple {
namespace {

constexpr int kReach = 16;  // pixels

struct Step {
  int x, y;
  [[nodiscard]] int square() const { return x * x + y * y; }
};

/// All steps of kReach at most, the shortest first.
std::vector<Step> steps_by_length() {
  std::vector<Step> steps;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x)
      if (const Step step{x, y}; step.square() <= kReach * kReach) steps.push_back(step);
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.square() < b.square(); });
  return steps;
}

}  // namespace

std::vector<std::uint32_t> back_sources(std::uint32_t pixels, std::uint32_t width,
                                        const PixelTest& needs, const PixelTest& has) {
  const std::vector<Step> steps = steps_by_length();
  const auto columns = static_cast<int>(width), rows = static_cast<int>(pixels / width);
  std::vector<std::uint32_t> sources(pixels);
  tbb::parallel_for(0, rows, [&](int y) {
    for (int x = 0; x < columns; ++x) {
      const auto pixel = static_cast<std::uint32_t>(y) * width + static_cast<std::uint32_t>(x);
      sources[pixel] = pixel;
      if (!needs(pixel)) continue;
      for (const Step& step : steps) {
        const int at_x = x + step.x, at_y = y + step.y;
        if (at_x < 0 || at_y < 0 || at_x >= columns || at_y >= rows) continue;
        const auto at = static_cast<std::uint32_t>(at_y) * width + static_cast<std::uint32_t>(at_x);
        if (!has(at)) continue;
        sources[pixel] = at;
        break;
      }
    }
  });
  return sources;
}

}  // namespace dapple
