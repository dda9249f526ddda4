// The steps of writing a preview, for callers that need them separately. In: a film and the name of
// a layer. Out: the exposure of the layer, its pixels as bytes, and the bytes of a PNG file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dapple/film.hpp"

namespace dapple {

/// shown = (value - offset) * scale, clamped to [0,1] and, for colours, encoded as sRGB.
struct Tone {
  float offset = 0.0f;
  float scale = 1.0f;
  bool srgb = true;
};

/// Top row first, `channels` bytes a pixel (1 grey, 3 RGB, 4 RGB and alpha that is not multiplied).
struct ByteImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::uint8_t> bytes;
};

/// The tone that maps the values of `layer` into [0,1]. Layers are named as in write_png(). Throws
/// Error usage when there is no such layer.
Tone layer_tone(const Film& film, const std::string& layer);

/// The pixels of `layer`. The film must have no film_defect(). Throws like layer_tone().
ByteImage layer_image(const Film& film, const std::string& layer, const Tone& tone);

/// The bytes of a PNG file. `name` is used in error messages only. Throws Error failed when there
/// are too many pixels.
std::string encode_png(const ByteImage& image, const std::string& name);

/// The same for an image of one channel of 16 bits, linear: `grey`, row by row from the top.
std::string encode_grey16_png(int width, int height, const std::vector<std::uint16_t>& grey,
                              const std::string& name);

}  // namespace dapple
