// Decodes WebP images with libwebp. In: the bytes of a file; out: pixels, or why there are none.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dapple {

/// The header of a WebP file, whose bytes must outlive it.
class WebpImage {
 public:
  explicit WebpImage(std::span<const std::uint8_t> bytes);

  /// The end of a message, "is an animation": such a file has no pixels to be read. Empty: it has.
  [[nodiscard]] const std::string& defect() const { return defect_; }
  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }

  /// Returns four bytes per pixel, top row first, which the caller frees with free(); null where
  /// the data are damaged or cut off. Alpha is 255 in images without it.
  [[nodiscard]] std::uint8_t* decode_rgba() const;
  static void free(void* pixels);

 private:
  std::span<const std::uint8_t> bytes_;
  std::string defect_;
  std::uint32_t width_ = 0, height_ = 0;
};

}  // namespace dapple
