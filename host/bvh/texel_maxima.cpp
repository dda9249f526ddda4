#include "bvh/texel_maxima.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dapple {
namespace {

/// Squares along an axis that are looked at; with more answers would be sharper and take longer.
constexpr int kMostSquares = 4;

/// Texels by which coordinates may be off.
constexpr float kMargin = 0.01f;

/// Ranges of texels of an axis, where a range goes over the tile's end.
template <class Range>
struct Ranges {
  std::array<Range, 2> range;
  int count = 1;
};

/// Which of `size` texels lookups between two coordinates read.
template <class Range>
Ranges<Range> texels_between(float from, float to, int size, Wrap wrap) {
  const Ranges<Range> all{{{{0, size - 1}, {}}}, 1};
  const float tiles = wrap == Wrap::repeat ? std::floor(from) : 0.0f;
  const float scale = static_cast<float>(size);
  const float low = std::floor((from - tiles) * scale - 0.5f - kMargin);
  const float high = std::floor((to - tiles) * scale + 0.5f + kMargin);
  if (!(high - low < scale)) return all;  // NaN, too
  if (wrap == Wrap::mirror && !(low >= -1.0f && high <= scale)) return all;
  const auto clamped = [&](float x) { return static_cast<int>(std::clamp(x, 0.0f, scale - 1)); };
  if (wrap != Wrap::repeat || (low >= 0.0f && high < scale))
    return {{{{clamped(low), clamped(high)}, {}}}, 1};
  // `low` is in the tile or the texel before it.
  const int first = (static_cast<int>(low) + size) % size;
  const int last = static_cast<int>(high) % size;
  if (first <= last) return all;
  return {{{{first, size - 1}, {0, last}}}, 2};
}

}  // namespace

TexelMaxima::TexelMaxima(const Texture& texture) : texture_(texture) {
  levels_.push_back({static_cast<int>(texture.width), static_cast<int>(texture.height), {}});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    const std::uint8_t* from = fine.most.empty() ? texture.alpha.data() : fine.most.data();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.most.resize(static_cast<std::size_t>(coarse.width) * coarse.height);
    tbb::parallel_for(0, coarse.height, [&](int y) {
      const std::size_t width = static_cast<std::size_t>(fine.width);
      const std::uint8_t* upper = from + 2 * static_cast<std::size_t>(y) * width;
      const std::uint8_t* lower = 2 * y + 1 < fine.height ? upper + width : upper;
      std::uint8_t* to = &coarse.most[static_cast<std::size_t>(y) * coarse.width];
      for (int x = 0; x < coarse.width; ++x) {
        const int left = 2 * x, right = std::min(left + 1, fine.width - 1);
        to[x] = std::max({upper[left], upper[right], lower[left], lower[right]});
      }
    });
    levels_.push_back(std::move(coarse));
  }
}

bool TexelMaxima::reaches(Range columns, Range rows, int least) const {
  const int span = std::max(columns.last - columns.first, rows.last - rows.first);
  std::size_t k = 0;
  while (k + 1 < levels_.size() && (span >> k) >= kMostSquares) ++k;
  const Level& level = levels_[k];
  const std::uint8_t* most = k == 0 ? texture_.alpha.data() : level.most.data();
  for (int row = rows.first >> k; row <= rows.last >> k; ++row) {
    for (int column = columns.first >> k; column <= columns.last >> k; ++column) {
      if (most[static_cast<std::size_t>(row) * level.width + column] >= least) return true;
    }
  }
  return false;
}

bool TexelMaxima::may_reach(V2f from, V2f to, int least) const {
  const auto columns = texels_between<Range>(from.x, to.x, levels_[0].width, texture_.wrap_s);
  const auto rows = texels_between<Range>(from.y, to.y, levels_[0].height, texture_.wrap_t);
  for (int i = 0; i < columns.count; ++i) {
    for (int j = 0; j < rows.count; ++j) {
      if (reaches(columns.range[i], rows.range[j], least)) return true;
    }
  }
  return false;
}

}  // namespace dapple
