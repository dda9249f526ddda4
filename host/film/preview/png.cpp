// 8-bit previews: one layer of a film as a PNG of the data window's size. Colours get the
// sRGB curve; normals and distances are data and stay linear. RGBA is exposed and tone mapped. In:
// a Film. Out: a file.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include "film/preview/png.hpp"

#include <fmt/format.h>
#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>

#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "files/output_file.hpp"
#include "film/film_defect.hpp"
#include "film/preview/heat_color.hpp"
#include "film/preview/pixel_elevation.hpp"
#include "film/preview/tone_map.hpp"
#include "scene/check/enumerator.hpp"
#include "scene/images/color.hpp"

namespace dapple {
namespace {

using Planes = std::vector<const Plane*>;  // three of a colour or vector, or one

Planes find_triple(const Film& film, const std::string& prefix, const char* letters) {
  Planes planes;
  for (int i = 0; i < 3; ++i) {
    const Plane* plane = film.find(prefix + letters[i]);
    if (plane == nullptr) return {};
    planes.push_back(plane);
  }
  return planes;
}

[[noreturn]] void refuse_layer(const Film& film, const std::string& layer) {
  std::string channels;
  for (const Plane& plane : film.planes) channels += " " + plane.channel;
  throw Error(ErrorKind::usage, "there is no layer " + (layer.empty() ? "RGBA" : layer) +
                                    " for the PNG; the film's channels are:" + channels);
}

Planes planes_of(const Film& film, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  for (const char* letters : {"RGB", "XYZ"}) {
    Planes planes = find_triple(film, prefix, letters);
    if (!planes.empty()) return planes;
  }
  const Plane* single = film.find(layer);
  if (single == nullptr) refuse_layer(film, layer);
  return {single};
}

struct Range {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

Range finite_range(const Planes& planes) {
  Range range;
  for (const Plane* plane : planes) {
    for (const float value : plane->pixels) {
      if (!std::isfinite(value)) continue;
      range.low = std::min(range.low, value);
      range.high = std::max(range.high, value);
    }
  }
  return range;
}

Tone tone_of(const Film& film, const std::string& layer, const Planes& planes) {
  if (layer.empty()) return {0.0f, automatic_exposure(film), true};
  if (layer == "N" || layer == "Ng") return {-1.0f, 0.5f, false};
  const Range range = finite_range(planes);
  if (layer == "Z" || layer == "P") {
    const float span = range.high - range.low;
    return {range.low, span > 0 ? 1 / span : 1.0f, false};
  }
  if (layer.starts_with("light.") || layer.starts_with("beauty."))
    return {0.0f, range.high > 0 ? 1 / range.high : 1.0f, true};
  return {};
}

std::uint8_t shown(float value, const Tone& tone) {
  const float toned = (value - tone.offset) * tone.scale;
  const float clamped = toned > 0 ? std::min(toned, 1.0f) : 0.0f;  // NaN becomes 0
  const float encoded = tone.srgb ? srgb_from_linear(clamped) : clamped;
  return static_cast<std::uint8_t>(std::lround(encoded * 255.0f));
}

std::uint8_t byte_of(float value) {
  const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;  // NaN becomes 0
  return static_cast<std::uint8_t>(std::lround(clamped * 255.0f));
}

/// RGBA, exposed, tone mapped and put over the background. Edges are mixed on the display's side: a
/// bright leaf that covers half of a pixel is half of it.
ByteImage main_picture(const Film& film, const PngOptions& options) {
  const Planes colors = planes_of(film, "");
  const Plane* alphas = film.find("A");
  const float scale = options.exposure ? std::exp2(*options.exposure) : automatic_exposure(film);
  const bool with_alpha = options.background == PngOptions::Background::none;
  const PixelElevation elevation(film);
  const PixelRect& window = film.data_window;
  const std::size_t width = static_cast<std::size_t>(window.width());
  const std::size_t pixels = colors.front()->pixels.size(), channels = with_alpha ? 4 : 3;
  ByteImage image{window.width(), window.height(), static_cast<int>(channels),
                  std::vector<std::uint8_t>(pixels * channels)};
  for (std::size_t p = 0; p < pixels; ++p) {
    const float alpha = alphas == nullptr ? 1.0f : std::clamp(alphas->pixels[p], 0.0f, 1.0f);
    const V3f linear(colors[0]->pixels[p], colors[1]->pixels[p], colors[2]->pixels[p]);
    V3f shown = alpha > 0 ? tone_mapped(linear * (scale / alpha)) : V3f(0, 0, 0);
    if (!with_alpha) {
      const float x = static_cast<float>(window.x0) + static_cast<float>(p % width) + 0.5f;
      const float y = static_cast<float>(window.y0) + static_cast<float>(p / width) + 0.5f;
      const V3f behind = options.background == PngOptions::Background::color
                             ? options.color
                             : backdrop_color(elevation.sine(x, y));
      shown = shown * alpha + behind * (1 - alpha);
    }
    for (int c = 0; c < 3; ++c)
      image.bytes[p * channels + static_cast<std::size_t>(c)] =
          byte_of(srgb_from_linear(std::clamp(shown[c], 0.0f, 1.0f)));
    if (with_alpha) image.bytes[p * channels + 3] = byte_of(alpha);
  }
  return image;
}

void append(void* bytes, void* data, int count) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data),
                                           static_cast<std::size_t>(count));
}

constexpr std::size_t kLargestImage = std::size_t{1} << 30;  // stb counts bytes in ints

[[noreturn]] void refuse_size(const std::string& name, int width, int height) {
  throw Error(ErrorKind::failed, "cannot write " + name + ": " + std::to_string(width) + " x " +
                                     std::to_string(height) + " pixels are too many for a PNG");
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<char>(value >> static_cast<unsigned>(shift)));
  return bytes;
}

/// A chunk: length, type, data and a CRC-32 (PNG specification, sections 5.3 and 5.5).
std::string png_chunk(const std::string& type, const std::string& data) {
  const std::string covered = type + data;
  std::uint32_t crc = ~0u;
  for (const char byte : covered) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + covered + big_endian(~crc);
}

}  // namespace

Tone layer_tone(const Film& film, const std::string& layer) {
  return tone_of(film, layer, planes_of(film, layer));
}

ByteImage layer_image(const Film& film, const std::string& layer, const Tone& tone) {
  const Planes planes = planes_of(film, layer);
  const std::size_t channels = planes.size();
  const std::size_t pixels = planes.front()->pixels.size();
  ByteImage image{film.data_window.width(), film.data_window.height(), static_cast<int>(channels),
                  std::vector<std::uint8_t>(pixels * channels)};
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < pixels; ++i) {
      image.bytes[i * channels + c] = shown(planes[c]->pixels[i], tone);
    }
  }
  return image;
}

std::string encode_png(const ByteImage& image, const std::string& name) {
  std::string bytes;
  if (image.bytes.size() > kLargestImage ||
      stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels,
                             image.bytes.data(), image.width * image.channels) == 0)
    refuse_size(name, image.width, image.height);
  return bytes;
}

// stb writes 8 bits only, but compresses anything.
std::string encode_grey16_png(int width, int height, const std::vector<std::uint16_t>& grey,
                              const std::string& name) {
  if (2 * grey.size() + static_cast<std::size_t>(height) > kLargestImage)
    refuse_size(name, width, height);
  std::vector<unsigned char> rows;
  rows.reserve(2 * grey.size() + static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (i % static_cast<std::size_t>(width) == 0) rows.push_back(0);  // no filter
    rows.push_back(static_cast<unsigned char>(grey[i] >> 8));
    rows.push_back(static_cast<unsigned char>(grey[i] & 0xff));
  }
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> packed(
      stbi_zlib_compress(rows.data(), static_cast<int>(rows.size()), &size, 8), &std::free);
  if (!packed) refuse_size(name, width, height);
  const std::string header = big_endian(static_cast<std::uint32_t>(width)) +
                             big_endian(static_cast<std::uint32_t>(height)) +
                             std::string("\x10\0\0\0\0", 5);  // 16 bits, grey
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) +
         png_chunk("IDAT",
                   {reinterpret_cast<const char*>(packed.get()), static_cast<std::size_t>(size)}) +
         png_chunk("IEND", {});
}

void validate(const PngOptions& options) {
  constexpr float kMaxStops = 100;
  using Background = PngOptions::Background;
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::usage, what); };
  if (options.exposure && !(std::fabs(*options.exposure) <= kMaxStops))
    refuse(fmt::format("--exposure {}: it is auto, or from -{:g} to {:g}", *options.exposure,
                       kMaxStops, kMaxStops));
  if (!is_enumerator(options.background, Background::color))
    refuse(fmt::format("--background has no value {}", static_cast<int>(options.background)));
  if (options.background != Background::color) return;
  const V3f& color = options.color;
  for (int channel = 0; channel < 3; ++channel)
    if (!(color[channel] >= 0 && color[channel] <= 1))
      refuse(fmt::format("--background {},{},{}: it is sky, none or R,G,B from 0 to 1", color.x,
                         color.y, color.z));
}

void write_png(const Film& film, const std::string& path, const std::string& layer,
               const PngOptions& options) {
  validate(options);
  const std::string defect = film_defect(film);
  if (!defect.empty()) throw Error(ErrorKind::failed, "cannot write " + path + ": " + defect);
  const ByteImage image = layer.empty() ? main_picture(film, options)
                                        : layer_image(film, layer, layer_tone(film, layer));
  write_whole_file(path, encode_png(image, path));
}

void write_heat_map(const Film& film, const std::string& path, const std::string& channel) {
  const std::string defect = film_defect(film);
  if (!defect.empty()) throw Error(ErrorKind::failed, "cannot write " + path + ": " + defect);
  const Plane* plane = film.find(channel);
  if (plane == nullptr) refuse_layer(film, channel);
  const float largest = finite_range({plane}).high;
  ByteImage image{film.data_window.width(), film.data_window.height(), 3, {}};
  image.bytes.reserve(plane->pixels.size() * 3);
  for (const float value : plane->pixels) {
    const Rgb color = heat_color(largest > 0 ? value / largest : 0.0f);
    image.bytes.insert(image.bytes.end(), color.begin(), color.end());
  }
  write_whole_file(path, encode_png(image, path));
}

}  // namespace dapple
