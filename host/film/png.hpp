// The steps of a preview, for callers that need them apart: how a layer's values become shades,
// the shades as bytes, and the bytes as a PNG.
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

/// Top row first, `channels` bytes a pixel (1 grey, 3 RGB).
struct ByteImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::uint8_t> bytes;
};

/// The exposure that maps `layer` of `film` into the displayed range. Layers are named as in
/// write_png; throws Error usage when there is no such layer.
Tone layer_tone(const Film& film, const std::string& layer);

/// `layer` of a film without defects. Throws as layer_tone does.
ByteImage layer_image(const Film& film, const std::string& layer, const Tone& tone);

/// A whole PNG file. `name` is for the message alone. Throws Error failed when there are too
/// many pixels.
std::string encode_png(const ByteImage& image, const std::string& name);

}  // namespace dapple
