#include "bvh/opacity/opacity_mip_levels.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "scene/images/wrapped_texel.hpp"

namespace dapple {
namespace {

/// The largest whole number that is not above `x`, which has fewer digits than an int.
int floored(float x) {
  const int toward_zero = static_cast<int>(x);
  return toward_zero - (x < static_cast<float>(toward_zero) ? 1 : 0);
}

/// Returns an equivalent texture coordinate near [0,1), so that the index of its texel fits in an
/// int.
float folded_coordinate(float u, Wrap mode) {
  if (u >= 0 && u < 1) return u;
  return mode == Wrap::clamp ? std::clamp(u, -1.0f, 2.0f) : u - 2.0f * std::floor(0.5f * u);
}

/// The texels of a finer axis that one texel of a coarser axis covers. If the size is odd, texels
/// are divided between two coarser ones in proportion to the length, so that means are preserved.
struct Shares {
  int first = 0, count = 0;
  float share[4] = {};  ///< four are enough: the ratio of sizes is between 1 and 3
};

std::vector<Shares> shares_of(int fine, int coarse) {
  std::vector<Shares> all(static_cast<std::size_t>(coarse));
  const double scale = static_cast<double>(fine) / coarse;
  for (int c = 0; c < coarse; ++c) {
    const double begin = c * scale, end = begin + scale;
    Shares& shares = all[static_cast<std::size_t>(c)];
    shares.first = static_cast<int>(begin);
    for (int f = shares.first; f < fine && f < end && shares.count < 4; ++f) {
      const double inside = std::min(end, f + 1.0) - std::max(begin, static_cast<double>(f));
      shares.share[shares.count++] = static_cast<float>(inside / scale);
    }
  }
  return all;
}

OpacityMipLevels::Level coarser(const OpacityMipLevels::Level& fine) {
  OpacityMipLevels::Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
  coarse.opacity.resize(static_cast<std::size_t>(coarse.width) * coarse.height);
  const std::vector<Shares> columns = shares_of(fine.width, coarse.width);
  const std::vector<Shares> rows = shares_of(fine.height, coarse.height);
  tbb::parallel_for(0, coarse.height, [&](int y) {
    const Shares& down = rows[static_cast<std::size_t>(y)];
    float* to = &coarse.opacity[static_cast<std::size_t>(y) * coarse.width];
    for (int x = 0; x < coarse.width; ++x) {
      const Shares& across = columns[static_cast<std::size_t>(x)];
      float sum = 0;
      for (int j = 0; j < down.count; ++j) {
        const float* from =
            &fine.opacity[static_cast<std::size_t>(down.first + j) * fine.width + across.first];
        float of_row = 0;
        for (int i = 0; i < across.count; ++i) of_row += across.share[i] * from[i];
        sum += down.share[j] * of_row;
      }
      to[x] = sum;
    }
  });
  return coarse;
}

/// Alphas of the texels around one, row by row.
struct Neighbourhood {
  std::array<float, 9> alpha;

  Neighbourhood(const Texture& texture, int x, int y) {
    const auto width = static_cast<int>(texture.width), height = static_cast<int>(texture.height);
    auto to = alpha.begin();
    for (const int row : {y - 1, y, y + 1}) {
      const auto first =
          static_cast<std::size_t>(wrapped_texel(row, height, texture.wrap_t)) * texture.width;
      for (const int column : {x - 1, x, x + 1}) {
        const auto at =
            first + static_cast<std::size_t>(wrapped_texel(column, width, texture.wrap_s));
        *to++ = static_cast<float>(texture.alpha[at]) * (1.0f / 255.0f);
      }
    }
  }

  /// Bilinear, at a point of the middle texel's square, [0,1].
  [[nodiscard]] float at(float x, float y) const {
    const std::size_t left = x < 0.5f ? 0 : 1, top = y < 0.5f ? 0 : 1;
    const float fx = x < 0.5f ? x + 0.5f : x - 0.5f, fy = y < 0.5f ? y + 0.5f : y - 0.5f;
    const float* row = &alpha[3 * top + left];
    return (row[0] * (1 - fx) + row[1] * fx) * (1 - fy) + (row[3] * (1 - fx) + row[4] * fx) * fy;
  }
};

/// The share of a line along which alpha runs from `a` to `b` that is opaque.
float opaque_part(float a, float b, float cutoff) {
  const float of_a = thresholded(a, cutoff);
  if (of_a == thresholded(b, cutoff)) return of_a;
  const float before = (cutoff - a) / (b - a);
  return of_a > 0 ? before : 1 - before;
}

/// The least and the greatest alpha of the nine texels around each texel of a row.
struct AlphaRanges {
  std::vector<std::uint8_t> least, most;

  AlphaRanges(const Texture& texture, int y) : least(texture.width), most(texture.width) {
    const auto width = static_cast<int>(texture.width), height = static_cast<int>(texture.height);
    const auto row = [&](int at) {
      return texture.alpha.data() +
             static_cast<std::size_t>(wrapped_texel(at, height, texture.wrap_t)) * texture.width;
    };
    // Of three rows, with a column more at each end. Simple loops, for vectors of bytes.
    const std::uint8_t *const above = row(y - 1), *const here = row(y), *const below = row(y + 1);
    std::vector<std::uint8_t> low(texture.width + 2), high(texture.width + 2);
    for (std::size_t x = 0; x < texture.width; ++x) {
      low[x + 1] = std::min(std::min(above[x], here[x]), below[x]);
      high[x + 1] = std::max(std::max(above[x], here[x]), below[x]);
    }
    const auto before = static_cast<std::size_t>(wrapped_texel(-1, width, texture.wrap_s));
    const auto after = static_cast<std::size_t>(wrapped_texel(width, width, texture.wrap_s));
    low.front() = low[before + 1];
    high.front() = high[before + 1];
    low.back() = low[after + 1];
    high.back() = high[after + 1];
    for (std::size_t x = 0; x < texture.width; ++x) {
      least[x] = std::min(std::min(low[x], low[x + 1]), low[x + 2]);
      most[x] = std::max(std::max(high[x], high[x + 1]), high[x + 2]);
    }
  }
};

/// The share of a texel's square that is opaque, if an edge runs through it: exactly along four
/// lines across the edge.
float opaque_share(const Texture& texture, int x, int y, float factor, float cutoff) {
  constexpr int kLines = 4;
  const Neighbourhood around(texture, x, y);
  float by_x = 0, by_y = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    by_x += std::fabs(around.alpha[3 * i + 2] - around.alpha[3 * i + 1]) +
            std::fabs(around.alpha[3 * i + 1] - around.alpha[3 * i]);
    by_y += std::fabs(around.alpha[6 + i] - around.alpha[3 + i]) +
            std::fabs(around.alpha[3 + i] - around.alpha[i]);
  }
  float sum = 0;
  for (int line = 0; line < kLines; ++line) {
    const float beside = (static_cast<float>(line) + 0.5f) / kLines;
    const auto at = [&](float along) {  // linear from 0 to 0.5 and from there to 1
      return factor * (by_x >= by_y ? around.at(along, beside) : around.at(beside, along));
    };
    const float middle = at(0.5f);
    sum += opaque_part(at(0), middle, cutoff) + opaque_part(middle, at(1), cutoff);
  }
  return sum / (2 * kLines);
}

}  // namespace

bool is_beyond_border(const std::array<V2f, 3>& uvs, Wrap wrap_s, Wrap wrap_t) {
  constexpr float kBeside = 0.02f;  // what exporters leave of roundings, and of bleeding
  const auto is_outside = [](float at) { return at < -kBeside || at > 1 + kBeside; };
  return std::any_of(uvs.begin(), uvs.end(), [&](const V2f& uv) {
    return (wrap_s == Wrap::clamp && is_outside(uv.x)) ||
           (wrap_t == Wrap::clamp && is_outside(uv.y));
  });
}

float thresholded(float alpha, float cutoff) {
  if (cutoff < 0.0f) return std::clamp(alpha, 0.0f, 1.0f);
  return alpha >= cutoff ? 1.0f : 0.0f;
}

OpacityMipLevels::OpacityMipLevels(const Texture& texture, float factor, float cutoff)
    : size_(static_cast<float>(texture.width), static_cast<float>(texture.height)),
      wrap_s_(texture.wrap_s),
      wrap_t_(texture.wrap_t) {
  Level base{static_cast<int>(texture.width), static_cast<int>(texture.height), {}};
  base.opacity.resize(texture.alpha.size());
  std::array<float, 256> opacity_of;  // by the code of alpha
  for (std::size_t code = 0; code < opacity_of.size(); ++code)
    opacity_of[code] = thresholded(static_cast<float>(code) * (1.0f / 255.0f) * factor, cutoff);
  const bool is_cut_bilinearly = cutoff >= 0 && !texture.nearest;
  tbb::parallel_for(0, base.height, [&](int y) {
    const std::size_t first = static_cast<std::size_t>(y) * texture.width;
    if (!is_cut_bilinearly) {
      for (std::size_t i = first; i < first + texture.width; ++i)
        base.opacity[i] = opacity_of[texture.alpha[i]];
      return;
    }
    const AlphaRanges around(texture, y);
    for (int x = 0; x < base.width; ++x) {
      const auto column = static_cast<std::size_t>(x);
      const float least = opacity_of[around.least[column]];
      const bool is_edge = least != opacity_of[around.most[column]];
      base.opacity[first + column] = is_edge ? opaque_share(texture, x, y, factor, cutoff) : least;
    }
  });
  levels_.push_back(std::move(base));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(coarser(levels_.back()));
}

float OpacityMipLevels::bilinear(const Level& level, V2f uv) const {
  const float x = uv.x * static_cast<float>(level.width) - 0.5f;
  const float y = uv.y * static_cast<float>(level.height) - 0.5f;
  const int left = floored(x), top = floored(y);
  const float fx = x - static_cast<float>(left), fy = y - static_cast<float>(top);
  const int columns[2] = {wrapped_texel(left, level.width, wrap_s_),
                          wrapped_texel(left + 1, level.width, wrap_s_)};
  const auto of_row = [&](int row) {
    const float* const texels =
        &level.opacity[static_cast<std::size_t>(wrapped_texel(row, level.height, wrap_t_)) *
                       level.width];
    return texels[columns[0]] * (1 - fx) + texels[columns[1]] * fx;
  };
  return of_row(top) * (1 - fy) + of_row(top + 1) * fy;
}

float OpacityMipLevels::mean(V2f uv, float width_texels) const {
  const V2f at(folded_coordinate(uv.x, wrap_s_), folded_coordinate(uv.y, wrap_t_));
  if (width_texels <= 1) return bilinear(levels_[0], at);
  const float level = std::clamp(std::log2(std::max(width_texels, 1.0f)), 0.0f,
                                 static_cast<float>(levels_.size() - 1));
  const auto fine = static_cast<std::size_t>(level);
  const auto coarse = std::min(fine + 1, levels_.size() - 1);
  const float blend = level - static_cast<float>(fine);
  return bilinear(levels_[fine], at) * (1 - blend) + bilinear(levels_[coarse], at) * blend;
}

std::size_t mip_level_texels(std::size_t width, std::size_t height) {
  std::size_t sum = width * height;
  while (width > 1 || height > 1) {
    width = std::max<std::size_t>(1, width / 2);
    height = std::max<std::size_t>(1, height / 2);
    sum += width * height;
  }
  return sum;
}

}  // namespace dapple
