// Decodes PNG and JPEG images with stb_image, WebP by webp.hpp: see image.hpp.
#include "scene/images/image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "dapple/error.hpp"
#include "scene/images/color.hpp"
#include "scene/images/image_structure.hpp"
#include "scene/images/webp.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#include <stb_image.h>

namespace dapple {
namespace {

/// Where a PNG has its colour type, after the depth.
constexpr std::size_t kColorTypeAt = 25;

struct StbiFree {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

struct Pixels {
  std::unique_ptr<std::uint8_t, void (*)(void*)> bytes{nullptr, stbi_image_free};
  std::size_t channels = 4;  ///< 2: grey and alpha; 3: RGB; 4: RGB and alpha
  std::size_t width = 0;
  std::size_t height = 0;

  [[nodiscard]] const std::uint8_t* pixel(std::size_t i) const {
    return bytes.get() + channels * i;
  }
};

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw Error(ErrorKind::input, what + ": " + why);
}

void check_size(std::uint64_t width, std::uint64_t height, const std::string& what) {
  if (width * height <= kMaxImagePixels) return;
  refuse(what, "is too large (" + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels, at most " + std::to_string(kMaxImagePixels) + " in all)");
}

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// stb_image checks the size too, but says "unknown" for a PNG that decodes to more than 2^30
/// bytes.
void check_png_size(std::span<const std::uint8_t> bytes, const std::string& what) {
  constexpr std::size_t kSizesEnd = 24;
  if (bytes.size() < kSizesEnd) refuse(what, "is corrupt (its PNG header)");
  check_size(big_endian(bytes.subspan(16, 4)), big_endian(bytes.subspan(20, 4)), what);
}

/// Checks format, structure and size before decoding, because 100 bytes of PNG can decode to
/// gigabytes.
void check_header(std::span<const std::uint8_t> bytes, const std::string& what) {
  const ImageFormat format = image_format(bytes);
  if (format == ImageFormat::other) refuse(what, "is none of PNG, JPEG and WebP");
  const bool png = format == ImageFormat::png;
  if (png) check_png_size(bytes, what);
  const std::string defect = png ? png_defect(bytes) : jpeg_defect(bytes);
  if (!defect.empty()) refuse(what, "is corrupt (" + defect + ")");
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height,
                            &channels) == 0) {
    refuse(what, png ? "is corrupt (its PNG header)" : "is corrupt (its JPEG header)");
  }
  check_size(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), what);
}

/// The chunks of a PNG with a palette but those of its colours, as a grey image whose values are
/// the indices. Its checksums are wrong, which the decoder does not check.
std::vector<std::uint8_t> indices_as_grey(std::span<const std::uint8_t> png) {
  constexpr std::size_t kSignature = 8, kOverhead = 12;
  std::vector<std::uint8_t> grey(png.begin(), png.begin() + kSignature);
  for (std::size_t at = kSignature; at + kOverhead <= png.size();) {
    const std::size_t length = kOverhead + big_endian(png.subspan(at, 4));
    const auto chunk = png.subspan(at, std::min(length, png.size() - at));
    const std::string_view type(reinterpret_cast<const char*>(chunk.data()) + 4, 4);
    if (type != "PLTE" && type != "tRNS") grey.insert(grey.end(), chunk.begin(), chunk.end());
    at += length;
  }
  grey[kColorTypeAt] = 0;
  return grey;
}

std::size_t palette_size(std::span<const std::uint8_t> png) {
  constexpr std::size_t kSignature = 8, kOverhead = 12;
  for (std::size_t at = kSignature; at + kOverhead <= png.size();) {
    const std::size_t length = big_endian(png.subspan(at, 4));
    const std::string_view type(reinterpret_cast<const char*>(png.data()) + at + 4, 4);
    if (type == "PLTE") return length / 3;
    at += kOverhead + length;
  }
  return 0;
}

/// The decoder reads colours that are not there for an index beyond the palette. `png` is checked.
void check_palette(std::span<const std::uint8_t> png, const std::string& what) {
  constexpr std::uint8_t kPalette = 3;
  if (png[kColorTypeAt] != kPalette) return;
  const std::size_t colors = palette_size(png), depth = png[kColorTypeAt - 1];
  if (colors >= std::size_t{1} << depth) return;
  const std::vector<std::uint8_t> grey = indices_as_grey(png);
  int width = 0, height = 0, in_file = 0;
  const std::unique_ptr<stbi_uc, StbiFree> values(stbi_load_from_memory(
      grey.data(), static_cast<int>(grey.size()), &width, &height, &in_file, 1));
  if (!values) return;                        // decoding the image itself says why
  const int step = 255 / ((1 << depth) - 1);  // the decoder stretches values to eight bits
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < count; ++i) {
    const auto index = static_cast<std::size_t>(values.get()[i] / step);
    if (index < colors) continue;
    const auto row = static_cast<std::size_t>(width);
    refuse(what, "is corrupt (pixel " + std::to_string(i % row) + ", " + std::to_string(i / row) +
                     " has the colour " + std::to_string(index) + " of a palette of " +
                     std::to_string(colors) + ")");
  }
}

Pixels decode_webp(std::span<const std::uint8_t> bytes, const std::string& what) {
  WebpImage image(bytes);
  if (!image.defect().empty()) refuse(what, image.defect());
  check_size(image.width(), image.height(), what);
  Pixels pixels{{image.decode_rgba(), WebpImage::free}, 4, image.width(), image.height()};
  if (!pixels.bytes) refuse(what, "is corrupt (its WebP data)");
  return pixels;
}

/// Decodes to `channels` bytes per pixel, WebP to four.
Pixels decode(std::span<const std::uint8_t> bytes, int channels, const std::string& what) {
  if (image_format(bytes) == ImageFormat::webp) return decode_webp(bytes, what);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    refuse(what, "has more than 2^31 bytes");
  }
  check_header(bytes, what);
  if (image_format(bytes) == ImageFormat::png) check_palette(bytes, what);
  const int size = static_cast<int>(bytes.size());
  int width = 0;
  int height = 0;
  int in_file = 0;
  Pixels pixels;
  pixels.bytes.reset(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &in_file, channels));
  if (!pixels.bytes) {
    refuse(what, std::string("is corrupt (") + stbi_failure_reason() + ")");
  }
  pixels.channels = static_cast<std::size_t>(channels);
  pixels.width = static_cast<std::size_t>(width);
  pixels.height = static_cast<std::size_t>(height);
  return pixels;
}

}  // namespace

std::uint64_t pixel_count(std::span<const std::uint8_t> bytes) {
  if (image_format(bytes) == ImageFormat::webp) {
    const WebpImage image(bytes);
    return image.defect().empty() ? std::uint64_t{image.width()} * image.height() : 0;
  }
  int width = 0, height = 0, channels = 0;
  const bool found = bytes.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) &&
                     stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width,
                                           &height, &channels) != 0;
  return found ? static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) : 0;
}

AlphaImage decode_alpha(std::span<const std::uint8_t> bytes, const std::string& what) {
  const Pixels pixels = decode(bytes, 2, what);
  AlphaImage image;
  image.width = static_cast<std::uint32_t>(pixels.width);
  image.height = static_cast<std::uint32_t>(pixels.height);
  image.alpha.resize(pixels.width * pixels.height);
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    image.alpha[i] = pixels.pixel(i)[pixels.channels - 1];
  }
  return image;
}

ColorImage decode_color(std::span<const std::uint8_t> bytes, const std::string& what) {
  const Pixels pixels = decode(bytes, 4, what);
  const std::size_t count = pixels.width * pixels.height;
  ColorImage image{static_cast<std::uint32_t>(pixels.width),
                   static_cast<std::uint32_t>(pixels.height), std::vector<std::uint8_t>(3 * count),
                   std::vector<std::uint8_t>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* pixel = pixels.pixel(i);
    std::copy_n(pixel, 3, &image.rgb[3 * i]);
    image.alpha[i] = pixel[3];
  }
  return image;
}

Imath::V3f mean_linear_color(std::span<const std::uint8_t> bytes, const std::string& what) {
  const Pixels pixels = decode(bytes, 3, what);
  const std::size_t count = pixels.width * pixels.height;
  std::array<std::array<std::uint64_t, 256>, 3> histogram{};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) ++histogram[c][pixels.pixel(i)[c]];
  Imath::V3f mean(0.0f);
  for (int channel = 0; channel < 3; ++channel) {
    double sum = 0;
    for (std::size_t level = 0; level < 256; ++level) {
      sum += linear_from_srgb(static_cast<double>(level) / 255.0) *
             static_cast<double>(histogram[static_cast<std::size_t>(channel)][level]);
    }
    mean[channel] = static_cast<float>(sum / static_cast<double>(count));
  }
  return mean;
}

}  // namespace dapple
