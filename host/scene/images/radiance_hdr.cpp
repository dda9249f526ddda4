// Decodes Radiance HDR images with stb_image: see radiance_hdr.hpp. stb_image does not check that a
// file is complete, so this file checks it first.
#include "scene/images/radiance_hdr.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
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

/// Whether the file has data for all pixels. stb_image would read zeros past the end, and would
/// loop forever at a run of length zero.
bool is_whole(std::span<const std::uint8_t> bytes, int width, int height) {
  std::span<const std::uint8_t> left = bytes.subspan(end_of_header(bytes));
  const auto is_encoded = [&] {
    return width >= 8 && width < 32768 && left.size() >= 4 && left[0] == 2 && left[1] == 2 &&
           (left[2] << 8 | left[3]) == width;
  };
  if (!is_encoded())
    return left.size() >=
           std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (int row = 0; row < height; ++row) {
    if (!is_encoded()) return false;
    left = left.subspan(4);
    for (int channel = 0; channel < 4; ++channel)
      if (!skip_channel(left, width)) return false;
  }
  return true;
}

}  // namespace

bool is_radiance_hdr(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("#?RADIANCE\n") || text.starts_with("#?RGBE\n");
}

Environment decode_radiance_hdr(std::span<const std::uint8_t> bytes, const std::string& what) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    refuse(what, "has more than 2^31 bytes");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0 || width < 1 ||
      height < 1)
    refuse(what, "is corrupt (its Radiance header)");
  if (std::int64_t{width} * height > kMaxPixels) {
    refuse(what, "is too large (" + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, at most " + std::to_string(kMaxPixels) + " in all)");
  }
  if (!is_whole(bytes, width, height)) refuse(what, "is corrupt or ends early");
  const std::unique_ptr<float, StbiFree> pixels(
      stbi_loadf_from_memory(bytes.data(), size, &width, &height, &channels, 3));
  if (!pixels) refuse(what, std::string("is corrupt (") + stbi_failure_reason() + ")");
  Environment environment{
      static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  environment.radiance.resize(std::size_t{environment.width} * environment.height);
  tbb::parallel_for(std::size_t{0}, environment.radiance.size(), [&](std::size_t i) {
    const float* rgb = pixels.get() + 3 * i;
    environment.radiance[i] = V3f(rgb[0], rgb[1], rgb[2]);
  });
  return environment;
}

}  // namespace dapple
