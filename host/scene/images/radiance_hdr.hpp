// Decodes Radiance HDR images (.hdr, RGBE) from memory. In: the bytes of a file; out: rows of
// linear RGB radiance. Only image.cpp and radiance_hdr.cpp use stb_image.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Whether the first bytes are those of a Radiance HDR image.
bool is_radiance_hdr(std::span<const std::uint8_t> bytes);

/// An image whose rows are decoded when they are asked for.
class RadianceImage {
 public:
  /// `bytes` must outlive it. Throws Error input if they are not a whole image of at most 2^27
  /// pixels; the message begins with `what`.
  RadianceImage(std::span<const std::uint8_t> bytes, const std::string& what);

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }

  /// The pixels of `count` rows from row `first` on. Several threads may ask at once.
  [[nodiscard]] std::vector<V3f> rows(std::uint32_t first, std::uint32_t count) const;

 private:
  std::span<const std::uint8_t> bytes_;
  std::string what_;
  std::uint32_t width_ = 0, height_ = 0;
  std::size_t begin_ = 0;                // offset of the pixels
  std::vector<std::size_t> row_starts_;  // offsets, one more than rows; empty: rows not encoded
};

}  // namespace dapple
