// Takes the image of a dome light strip by strip, so that a large image is never in memory as a
// whole. In: strips of rows. Out: an Environment of limited size, whose texels are checked.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The largest radiance of a light, as in lights files: sums over lights and pixels stay finite.
inline constexpr float kMaxRadiance = 1e30f;

/// Images of more than 2048x1024 texels are averaged down to at most this size, weighted by solid
/// angle: texels smaller than a sixth of a degree make no visible difference to the light.
class DomeRows {
 public:
  /// Of the image that is added; both above 0.
  DomeRows(std::uint32_t width, std::uint32_t height);

  [[nodiscard]] bool is_scaled() const { return across_ > 1 || down_ > 1; }

  struct Strip {
    std::uint32_t first = 0, count = 0;  ///< rows of the image
    std::uint32_t row = 0, rows = 0;     ///< of the result, which they make
  };

  /// Strips of about `rows` rows. Neighbours share a row of the image whose parts belong to a row
  /// of the result of each.
  [[nodiscard]] std::vector<Strip> strips(std::uint32_t rows) const;

  /// Rows of the image that one row of the result averages, rounded down.
  [[nodiscard]] std::uint32_t rows_of_texel() const { return down_; }

  /// Adds the pixels of one of strips(). Several threads may add strips at once. Negative values
  /// become 0.
  void add(const Strip& strip, std::span<const V3f> pixels);

  /// Once all strips are added. Throws Error input, "PATH: REASON", if a pixel is not finite or
  /// above kMaxRadiance.
  Environment take(const std::string& path);

 private:
  void check(std::size_t first_pixel, std::span<const V3f> pixels);
  /// The first row of the image that has a part in a row of the result; of the row after the last:
  /// the height.
  [[nodiscard]] std::uint32_t first_row(std::uint32_t row) const;
  /// The first row of the image that has no part in the rows before a row of the result.
  [[nodiscard]] std::uint32_t end_row(std::uint32_t row) const;
  void average(std::uint32_t row, const V3f* pixels);

  std::uint32_t width_, height_;  // of the image
  std::uint32_t across_, down_;   // pixels of the image for one texel of the result
  Environment result_;
  std::atomic<std::size_t> negative_ = 0;
  std::mutex refusal_;
  std::size_t refused_ = std::numeric_limits<std::size_t>::max();  // the first such pixel
  V3f refused_radiance_;
};

}  // namespace dapple
