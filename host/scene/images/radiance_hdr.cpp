// Decodes Radiance HDR images with stb_image: see radiance_hdr.hpp. stb_image does not check that a
// file is complete, so this file checks it first.
#include "scene/images/radiance_hdr.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include "dapple/error.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_HDR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace dapple {
namespace {

/// stb_image counts the bytes of its floats in an int.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 27;

struct StbiFree {
  void operator()(float* pixels) const { stbi_image_free(pixels); }
};

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw Error(ErrorKind::input, what + ": " + why);
}

/// Returns the offset of the pixels: they follow an empty line and the line of the resolution.
std::size_t end_of_header(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t empty = text.find("\n\n");
  if (empty == std::string_view::npos) return bytes.size();
  const std::size_t end = text.find('\n', empty + 2);
  return end == std::string_view::npos ? bytes.size() : end + 1;
}

/// Skips one of the four channels of a run-length encoded scanline. Returns false when its runs do
/// not make exactly `width` values.
bool skip_channel(std::span<const std::uint8_t>& left, int width) {
  for (int filled = 0; filled < width;) {
    if (left.empty()) return false;
    const int code = left[0], run = code > 128 ? code - 128 : code;
    const std::size_t stored = code > 128 ? 2 : std::size_t{1} + static_cast<std::size_t>(code);
    if (run == 0 || run > width - filled || left.size() < stored) return false;
    left = left.subspan(stored);
    filled += run;
  }
  return true;
}

/// Whether a scanline of that width begins here that is run-length encoded.
bool is_encoded(std::span<const std::uint8_t> left, int width) {
  return width >= 8 && width < 32768 && left.size() >= 4 && left[0] == 2 && left[1] == 2 &&
         (left[2] << 8 | left[3]) == width;
}

/// Offsets of the encoded scanlines, and that of their end. Empty if there is not data for all of
/// them: stb_image would read zeros past the end, and would loop forever at a run of length zero.
std::vector<std::size_t> find_rows(std::span<const std::uint8_t> bytes, std::size_t begin,
                                   int width, int height) {
  std::span<const std::uint8_t> left = bytes.subspan(begin);
  std::vector<std::size_t> starts;
  for (int row = 0; row < height; ++row) {
    starts.push_back(bytes.size() - left.size());
    if (!is_encoded(left, width)) return {};
    left = left.subspan(4);
    for (int channel = 0; channel < 4; ++channel)
      if (!skip_channel(left, width)) return {};
  }
  starts.push_back(bytes.size() - left.size());
  return starts;
}

V3f of_rgbe(const std::uint8_t* pixel) {
  const float scale = pixel[3] == 0 ? 0.0f : std::ldexp(1.0f, pixel[3] - 136);
  return V3f(pixel[0], pixel[1], pixel[2]) * scale;
}

/// Decodes an image with encoded scanlines.
std::vector<V3f> decode(std::span<const std::uint8_t> bytes, const std::string& what) {
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<float, StbiFree> pixels(stbi_loadf_from_memory(
      bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels, 3));
  if (!pixels) refuse(what, std::string("is corrupt (") + stbi_failure_reason() + ")");
  std::vector<V3f> radiance(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const float* rgb = pixels.get();
  for (V3f& pixel : radiance) {
    pixel = V3f(rgb[0], rgb[1], rgb[2]);
    rgb += 3;
  }
  return radiance;
}

}  // namespace

bool is_radiance_hdr(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("#?RADIANCE\n") || text.starts_with("#?RGBE\n");
}

RadianceImage::RadianceImage(std::span<const std::uint8_t> bytes, const std::string& what)
    : bytes_(bytes), what_(what) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    refuse(what, "has more than 2^31 bytes");
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height,
                            &channels) == 0 ||
      width < 1 || height < 1)
    refuse(what,
           "has a Radiance header that is corrupt or not supported: 32-bit_rle_rgbe and "
           "-Y HEIGHT +X WIDTH are");
  const std::int64_t pixels = std::int64_t{width} * height;
  if (pixels > kMaxPixels) {
    refuse(what, "is too large (" + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, at most " + std::to_string(kMaxPixels) + " in all)");
  }
  width_ = static_cast<std::uint32_t>(width);
  height_ = static_cast<std::uint32_t>(height);
  begin_ = end_of_header(bytes);
  if (is_encoded(bytes.subspan(begin_), width)) {
    row_starts_ = find_rows(bytes, begin_, width, height);
    if (row_starts_.empty()) refuse(what, "is corrupt or ends early");
  } else if (bytes.size() - begin_ < std::size_t{4} * static_cast<std::size_t>(pixels)) {
    refuse(what, "is corrupt, ends early, or has runs in the old encoding, which is not read");
  }
}

std::vector<V3f> RadianceImage::rows(std::uint32_t first, std::uint32_t count) const {
  if (row_starts_.empty()) {
    std::vector<V3f> radiance(std::size_t{count} * width_);
    const std::uint8_t* pixel = bytes_.data() + begin_ + std::size_t{4} * first * width_;
    for (V3f& of_pixel : radiance) {
      of_pixel = of_rgbe(pixel);
      pixel += 4;
    }
    return radiance;
  }
  // An image of these rows alone.
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(count) +
                             " +X " + std::to_string(width_) + "\n";
  std::vector<std::uint8_t> image(header.begin(), header.end());
  const auto rows =
      bytes_.subspan(row_starts_[first], row_starts_[first + count] - row_starts_[first]);
  image.insert(image.end(), rows.begin(), rows.end());
  return decode(image, what_);
}

}  // namespace dapple
