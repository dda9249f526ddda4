#include "bake/texture/dilation.hpp"

#include <algorithm>

namespace dapple {

std::vector<std::uint32_t> nearest_valid(const std::vector<bool>& valid, std::uint32_t size,
                                         int margin, const std::vector<bool>& within) {
  std::vector<std::uint32_t> nearest(valid.size(), kNoTexel);
  std::vector<std::uint32_t> border;
  for (std::uint32_t i = 0; i < valid.size(); ++i) {
    if (!valid[i]) continue;
    nearest[i] = i;
    border.push_back(i);
  }
  const int side = static_cast<int>(size);
  const auto square = [&](std::uint32_t from, int x, int y) {
    const long dx = static_cast<int>(from % size) - x, dy = static_cast<int>(from / size) - y;
    return dx * dx + dy * dy;
  };
  for (int ring = 0; ring < margin && !border.empty(); ++ring) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t at : border) {
      const std::uint32_t source = nearest[at];
      const int x = static_cast<int>(at % size), y = static_cast<int>(at / size);
      for (int v = std::max(0, y - 1); v <= std::min(side - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(side - 1, x + 1); ++u) {
          const auto to = static_cast<std::uint32_t>(v * side + u);
          if (valid[to] || (!within.empty() && !within[to])) continue;
          if (nearest[to] == kNoTexel) next.push_back(to);
          if (nearest[to] == kNoTexel || square(source, u, v) < square(nearest[to], u, v))
            nearest[to] = source;
        }
      }
    }
    border = std::move(next);
  }
  return nearest;
}

}  // namespace dapple
