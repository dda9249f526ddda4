// The units and tiles of a picture, by which its bias is estimated. In: a view. Out: for each pixel
// its unit, for each unit its tile. Both lie at the same places whatever the crop.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "camera/view.hpp"
#include "sampling/bias_estimate.hpp"
#include "sampling/exact_samples.hpp"

namespace dapple {

/// Tiles of a whole picture, at least.
inline constexpr double kMinBiasTiles = 64;

/// Side in pixels of the tiles of a picture: the largest power of two of which it has enough, but
/// at least two units: one alone does not tell its bias from its noise.
inline std::uint32_t bias_tile_side(int width, int height) {
  std::uint32_t side = 2 * kBiasUnit;
  while (static_cast<double>(width) * height / (4.0 * side * side) >= kMinBiasTiles) side *= 2;
  return side;
}

/// Pixels from `begin` up to `end`.
struct PixelRange {
  std::uint32_t begin = 0, end = 0;
};

class UnitGrid {
 public:
  explicit UnitGrid(const View& view)
      : crop_(view.crop),
        tile_units_(bias_tile_side(view.width, view.height) / kBiasUnit),
        first_x_(static_cast<std::uint32_t>(crop_.x0) / kBiasUnit),
        first_y_(static_cast<std::uint32_t>(crop_.y0) / kBiasUnit),
        columns_(static_cast<std::uint32_t>(crop_.x1) / kBiasUnit - first_x_ + 1),
        rows_(static_cast<std::uint32_t>(crop_.y1) / kBiasUnit - first_y_ + 1) {}

  [[nodiscard]] std::uint32_t row_count() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return std::size_t{columns_} * rows_; }
  [[nodiscard]] std::uint32_t column(std::size_t unit) const {
    return static_cast<std::uint32_t>(unit % columns_) + first_x_;
  }
  [[nodiscard]] std::uint32_t row(std::size_t unit) const {
    return static_cast<std::uint32_t>(unit / columns_) + first_y_;
  }

  /// The unit of a pixel of the crop.
  [[nodiscard]] std::size_t unit(std::uint32_t pixel) const {
    const auto width = static_cast<std::uint32_t>(crop_.width());
    const std::uint32_t x = pixel % width + static_cast<std::uint32_t>(crop_.x0);
    const std::uint32_t y = pixel / width + static_cast<std::uint32_t>(crop_.y0);
    return std::size_t{y / kBiasUnit - first_y_} * columns_ + (x / kBiasUnit - first_x_);
  }

  /// The pixels of a row of units, which follow each other; `row`: from 0 on.
  [[nodiscard]] PixelRange pixels_of_row(std::uint32_t row) const {
    const auto width = static_cast<std::uint32_t>(crop_.width());
    const auto first_line = [&](std::uint32_t r) {
      const int line = static_cast<int>((first_y_ + r) * kBiasUnit);
      return static_cast<std::uint32_t>(std::clamp(line, crop_.y0, crop_.y1 + 1) - crop_.y0);
    };
    return {first_line(row) * width, first_line(row + 1) * width};
  }

  /// All units, without values.
  [[nodiscard]] std::vector<BiasUnit> empty_units() const {
    std::vector<BiasUnit> units(size());
    for (std::size_t i = 0; i < units.size(); ++i)
      units[i].tile = row(i) / tile_units_ * 65536u + column(i) / tile_units_;
    return units;
  }

  /// The unit's pixels of the crop, in the order of tracing.
  [[nodiscard]] std::vector<std::uint32_t> pixels(std::size_t unit) const {
    std::vector<std::uint32_t> pixels;
    const auto limit = [](int a) { return static_cast<std::uint32_t>(a); };
    const std::uint32_t left = std::max(column(unit) * kBiasUnit, limit(crop_.x0));
    const std::uint32_t above = std::max(row(unit) * kBiasUnit, limit(crop_.y0));
    const std::uint32_t right = std::min((column(unit) + 1) * kBiasUnit, limit(crop_.x1 + 1));
    const std::uint32_t below = std::min((row(unit) + 1) * kBiasUnit, limit(crop_.y1 + 1));
    for (std::uint32_t y = above; y < below; ++y)
      for (std::uint32_t x = left; x < right; ++x)
        pixels.push_back((y - limit(crop_.y0)) * limit(crop_.width()) + x - limit(crop_.x0));
    return pixels;
  }

 private:
  PixelRect crop_;
  std::uint32_t tile_units_, first_x_, first_y_, columns_, rows_;
};

}  // namespace dapple
