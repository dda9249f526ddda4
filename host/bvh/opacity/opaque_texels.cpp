#include "bvh/opacity/opaque_texels.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// Squares of a table, at most.
constexpr std::size_t kMaxSquares = std::size_t{1} << 20;

/// The least byte of the texture's alpha with which the material is as opaque as with 255; 256 if
/// none is.
int threshold_of(const Material& material) {
  const float cutoff = cutoff_of(material);
  if (cutoff < 0) return 255;
  int byte = 0;
  while (byte < 256 && thresholded(static_cast<float>(byte) / 255 * material.alpha, cutoff) < 1)
    ++byte;
  return byte;
}

/// Ranges of texels of one axis, both ends included.
struct Ranges {
  int ends[2][2];
  int count;
};

int modulo(std::int64_t i, int size) {
  const auto r = static_cast<int>(i % size);
  return r < 0 ? r + size : r;
}

/// The texels that bilinear look-ups between two texture coordinates read.
Ranges ranges_of(float low, float high, int size, Wrap wrap) {
  const auto texel = [&](float u) {
    return static_cast<std::int64_t>(std::floor(double{u} * size - 0.5));
  };
  const std::int64_t first = texel(low), last = texel(high) + 1;
  if (wrap == Wrap::clamp) {
    const auto inside = [&](std::int64_t i) {
      return static_cast<int>(std::clamp<std::int64_t>(i, 0, size - 1));
    };
    return {{{inside(first), inside(last)}}, 1};
  }
  if (last - first + 1 >= size) return {{{0, size - 1}}, 1};
  const int from = modulo(first, size), to = modulo(last, size);
  if (wrap == Wrap::repeat) {
    if (from <= to) return {{{from, to}}, 1};
    return {{{from, size - 1}, {0, to}}, 2};
  }
  // Every other period is mirrored.
  const std::int64_t first_period = (first - from) / size, last_period = (last - to) / size;
  const int a = first_period % 2 != 0 ? size - 1 - from : from;
  const int b = last_period % 2 != 0 ? size - 1 - to : to;
  if (first_period == last_period) return {{{std::min(a, b), std::max(a, b)}}, 1};
  if (last_period % 2 != 0) return {{{std::min(a, b), size - 1}}, 1};
  return {{{0, std::max(a, b)}}, 1};
}

}  // namespace

void OpaqueTexels::Table::make() {
  const std::uint32_t width = texture->width, height = texture->height;
  while (std::size_t{width / square + 1} * (height / square + 1) > kMaxSquares) square *= 2;
  columns = (width + square - 1) / square;
  rows = (height + square - 1) / square;
  sums.assign(std::size_t{columns + 1} * (rows + 1), 0);
  const auto row_of_sums = [&](std::uint32_t row) {
    return &sums[std::size_t{row} * (columns + 1)];
  };
  tbb::parallel_for(0u, rows, [&](std::uint32_t row) {
    std::vector<std::uint8_t> least(columns, std::uint8_t{255});
    for (std::uint32_t y = row * square; y < std::min(height, (row + 1) * square); ++y) {
      const std::uint8_t* const of_row = &texture->alpha[std::size_t{y} * width];
      for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t first = column * square, end = std::min(width, first + square);
        least[column] = std::min(least[column], *std::min_element(of_row + first, of_row + end));
      }
    }
    std::uint32_t* const to = row_of_sums(row + 1);
    for (std::uint32_t column = 0; column < columns; ++column)
      to[column + 1] = to[column] + (least[column] < threshold ? 1 : 0);
  });
  for (std::uint32_t row = 1; row < rows; ++row) {
    const std::uint32_t* const above = row_of_sums(row);
    std::uint32_t* const to = row_of_sums(row + 1);
    for (std::uint32_t column = 0; column <= columns; ++column) to[column] += above[column];
  }
}

bool OpaqueTexels::Table::is_clear(const int (&x)[2], const int (&y)[2]) const {
  const auto before = [&](int texel) { return static_cast<std::uint32_t>(texel) / square; };
  const auto sum = [&](std::uint32_t column, std::uint32_t row) {
    return sums[std::size_t{row} * (columns + 1) + column];
  };
  const std::uint32_t left = before(x[0]), right = before(x[1]) + 1;
  const std::uint32_t top = before(y[0]), bottom = before(y[1]) + 1;
  return sum(right, bottom) + sum(left, top) == sum(left, bottom) + sum(right, top);
}

OpaqueTexels::OpaqueTexels(const Scene& scene) {
  std::map<std::pair<int, int>, int> known;
  for (const Material& material : scene.materials) {
    const int texture = material.alpha_texture;
    table_of_.push_back(-1);
    if (texture < 0 || material.alpha_mode == AlphaMode::opaque) continue;
    const int threshold = threshold_of(material);
    const auto [at, is_new] =
        known.try_emplace({texture, threshold}, static_cast<int>(tables_.size()));
    if (is_new) tables_.emplace_back(&scene.textures[static_cast<std::size_t>(texture)], threshold);
    table_of_.back() = at->second;
  }
}

bool OpaqueTexels::cover(const Mesh& mesh, std::uint32_t triangle) const {
  const int number = table_of_[mesh.materials[triangle]];
  if (number < 0) return false;
  Table& table = tables_[static_cast<std::size_t>(number)];
  std::call_once(table.made, [&] { table.make(); });
  constexpr float kFarthest = 1e9f;  // whose texels have numbers in 64 bits
  V2f low(kFarthest, kFarthest), high = -low;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const V2f& uv = mesh.uvs[mesh.indices[3 * std::size_t{triangle} + corner]];
    for (int axis = 0; axis < 2; ++axis) {
      if (!(std::fabs(uv[axis]) < kFarthest)) return false;
      low[axis] = std::min(low[axis], uv[axis]);
      high[axis] = std::max(high[axis], uv[axis]);
    }
  }
  const Texture& texture = *table.texture;
  const Ranges x = ranges_of(low.x, high.x, static_cast<int>(texture.width), texture.wrap_s);
  const Ranges y = ranges_of(low.y, high.y, static_cast<int>(texture.height), texture.wrap_t);
  for (int i = 0; i < x.count; ++i)
    for (int j = 0; j < y.count; ++j)
      if (!table.is_clear(x.ends[i], y.ends[j])) return false;
  return true;
}

}  // namespace dapple
