#include "device/upload/color_mip_levels.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

#include "scene/images/color.hpp"
#include "scene/images/wrapped_texel.hpp"

namespace dapple {
namespace {

/// A mip level: sums of colours times weights, and sums of weights.
struct WeightedLevel {
  std::uint32_t width = 0, height = 0;
  std::vector<V3f> color;
  std::vector<float> weight;
};

/// A colour and its weight.
struct WeightedTexel {
  V3f color;
  float weight;
};

/// How much a texel counts; 0: it is not seen.
float weight_of(const ColorTexture& texture, const TexelWeights& weights, std::size_t i) {
  if (texture.alpha.empty() || weights.kind == TexelWeights::Kind::equal) return 1;
  const std::uint8_t alpha = texture.alpha[i];
  if (weights.kind == TexelWeights::Kind::by_alpha) return static_cast<float>(alpha) / 255;
  return alpha >= weights.least_seen ? 1 : 0;
}

WeightedTexel texel_of(const ColorTexture& texture, const TexelWeights& weights, std::size_t i) {
  const float weight = weight_of(texture, weights, i);
  if (weight == 0) return {V3f(0, 0, 0), 0};
  const std::uint8_t* texel = &texture.rgb[3 * i];
  const auto& linear = linear_of_codes();
  return {V3f(linear[texel[0]], linear[texel[1]], linear[texel[2]]) * weight, weight};
}

/// The colour of a texel of a level that is not seen: the mean of the seen ones beside it, which
/// look-ups mix it with, else that of the texel of `coarser` that covers it. `texel`: of the level.
template <class Texel>
V3f color_of_unseen(const ColorTexture& texture, std::uint32_t width, std::uint32_t height,
                    const Texel& texel, const ColorLevel& coarser, std::uint32_t x,
                    std::uint32_t y) {
  std::size_t rows[3], columns[3];
  for (int k = 0; k < 3; ++k) {
    const int row = static_cast<int>(y) + k - 1, column = static_cast<int>(x) + k - 1;
    rows[k] =
        static_cast<std::size_t>(wrapped_texel(row, static_cast<int>(height), texture.wrap_t)) *
        width;
    columns[k] =
        static_cast<std::size_t>(wrapped_texel(column, static_cast<int>(width), texture.wrap_s));
  }
  WeightedTexel sum{V3f(0, 0, 0), 0};
  for (const std::size_t row : rows) {
    for (const std::size_t column : columns) {
      const WeightedTexel beside = texel(row + column);
      sum.color += beside.color;
      sum.weight += beside.weight;
    }
  }
  if (sum.weight > 0) return sum.color / sum.weight;
  const std::uint64_t above_x = std::uint64_t{x} * coarser.width / width;
  const std::uint64_t above_y = std::uint64_t{y} * coarser.height / height;
  return coarser.color[above_y * coarser.width + above_x];
}

/// Texels of a finer level that a coarse one covers along a side, and how much of them: two, or
/// parts of three where a size is odd.
struct CoveredTexels {
  std::uint32_t first, end;
  std::array<float, 3> share;
};

/// Those of each texel along a side.
std::vector<CoveredTexels> covered_texels(std::uint32_t fine, std::uint32_t coarse) {
  std::vector<CoveredTexels> all(coarse);
  for (std::uint64_t at = 0; at < coarse; ++at) {
    const std::uint64_t begin = at * fine, end = begin + fine;  // in parts of a fine texel
    CoveredTexels& covered = all[at];
    covered.first = static_cast<std::uint32_t>(begin / coarse);
    covered.end = static_cast<std::uint32_t>((end + coarse - 1) / coarse);
    for (std::uint32_t texel = covered.first; texel < covered.end; ++texel) {
      const std::uint64_t from = std::uint64_t{texel} * coarse;
      covered.share[texel - covered.first] =
          static_cast<float>(std::min(end, from + coarse) - std::max(begin, from)) /
          static_cast<float>(coarse);
    }
  }
  return all;
}

/// Sums of the texels of a finer level that each texel covers: two by two, or parts of three where
/// a size is odd.
template <class Texel>
WeightedLevel coarser(std::uint32_t width, std::uint32_t height, const Texel& texel) {
  WeightedLevel coarse{std::max(1u, width / 2), std::max(1u, height / 2), {}, {}};
  coarse.color.resize(std::size_t{coarse.width} * coarse.height);
  coarse.weight.resize(coarse.color.size());
  const std::vector<CoveredTexels> rows = covered_texels(height, coarse.height);
  const std::vector<CoveredTexels> columns = covered_texels(width, coarse.width);
  tbb::parallel_for(0u, coarse.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < coarse.width; ++x) {
      WeightedTexel sum{V3f(0, 0, 0), 0};
      for (std::uint32_t j = rows[y].first; j < rows[y].end; ++j) {
        for (std::uint32_t i = columns[x].first; i < columns[x].end; ++i) {
          const WeightedTexel one = texel(std::size_t{j} * width + i);
          const float share =
              rows[y].share[j - rows[y].first] * columns[x].share[i - columns[x].first];
          sum.color += one.color * share;
          sum.weight += one.weight * share;
        }
      }
      const std::size_t to = std::size_t{y} * coarse.width + x;
      coarse.color[to] = sum.color;
      coarse.weight[to] = sum.weight;
    }
  });
  return coarse;
}

}  // namespace

const std::array<float, 256>& linear_of_codes() {
  static const std::array<float, 256> kTable = [] {
    std::array<float, 256> values{};
    for (std::size_t code = 0; code < values.size(); ++code)
      values[code] = static_cast<float>(linear_from_srgb(static_cast<double>(code) / 255));
    return values;
  }();
  return kTable;
}

TexelWeights texel_weights(const Material& material) {
  if (material.alpha_mode == AlphaMode::opaque || material.alpha_texture < 0) return {};
  if (material.alpha_mode == AlphaMode::blend) return {TexelWeights::Kind::by_alpha, 0};
  int least = 0;
  while (least < 256 && material.alpha * (static_cast<float>(least) / 255) < material.alpha_cutoff)
    ++least;
  return {TexelWeights::Kind::cut_out, least};
}

TexelWeights weights_of_seen(const ColorTexture& texture, const TexelWeights& weights) {
  for (std::size_t i = 0; i < texture.rgb.size() / 3; ++i)
    if (weight_of(texture, weights, i) > 0) return weights;
  return {};
}

std::vector<ColorLevel> color_mip_levels(const ColorTexture& texture, const TexelWeights& given) {
  const TexelWeights weights = weights_of_seen(texture, given);
  std::vector<WeightedLevel> sums{{texture.width, texture.height, {}, {}}};
  while (sums.back().width > 1 || sums.back().height > 1) {
    const WeightedLevel& finer = sums.back();
    sums.push_back(sums.size() == 1
                       ? coarser(finer.width, finer.height,
                                 [&](std::size_t i) { return texel_of(texture, weights, i); })
                       : coarser(finer.width, finer.height, [&](std::size_t i) {
                           return WeightedTexel{finer.color[i], finer.weight[i]};
                         }));
  }
  std::vector<ColorLevel> levels(sums.size() - 1);
  for (std::size_t k = levels.size(); k-- > 0;) {
    const WeightedLevel& sum = sums[k + 1];
    ColorLevel& level = levels[k];
    level = {sum.width, sum.height, std::vector<V3f>(sum.color.size())};
    const auto texel = [&](std::size_t i) { return WeightedTexel{sum.color[i], sum.weight[i]}; };
    tbb::parallel_for(0u, sum.height, [&](std::uint32_t y) {
      for (std::uint32_t x = 0; x < sum.width; ++x) {
        const std::size_t i = std::size_t{y} * sum.width + x;
        level.color[i] = sum.weight[i] > 0 ? sum.color[i] / sum.weight[i]
                                           : color_of_unseen(texture, sum.width, sum.height, texel,
                                                             levels[k + 1], x, y);
      }
    });
    sums.pop_back();
  }
  return levels;
}

bool is_seen(const ColorTexture& texture, const TexelWeights& weights, std::size_t texel) {
  return weight_of(texture, weights, texel) > 0;
}

V3f color_of_unseen(const ColorTexture& texture, const TexelWeights& weights,
                    const ColorLevel& coarser, std::uint32_t x, std::uint32_t y) {
  return color_of_unseen(
      texture, texture.width, texture.height,
      [&](std::size_t i) { return texel_of(texture, weights, i); }, coarser, x, y);
}

}  // namespace dapple
