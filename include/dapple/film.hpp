// The finished picture: named planes of 32-bit floats and the metadata of an EXR file. In: values;
// out: EXR and PNG files. Also reads EXR files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// One EXR channel, e.g. "ao.R". Row-major over the film's data window, top row first.
struct Plane {
  std::string channel;
  std::vector<float> pixels;
};

/// Settings that the picture was made with; every field becomes EXR metadata.
struct FilmMetadata {
  M44f world_to_camera;  ///< EXR's convention: left-handed camera, +Z forward; row vectors
  M44f world_to_ndc;     ///< to x, y in [0,1] over the display window, y down, after division by w
  int samples = 0;       ///< RenderOptions::spp; with a target the least number
  std::uint32_t seed = 0;
  std::string scene, device, version;
  std::vector<std::pair<std::string, std::string>> settings;  ///< option name, value
  /// Of Cryptomattes: "cryptomatte/KEY/name" and others, which EXR files have under these names.
  std::vector<std::pair<std::string, std::string>> attributes;
};

/// Opacities at depths of each pixel, front to back. Composited over each other they give A.
struct DeepAlpha {
  struct Sample {
    float z = 0;      ///< as the layer Z, metres
    float alpha = 0;  ///< of this sample alone, (0,1]
  };
  std::vector<std::size_t> first;  ///< of each pixel, into `samples`; one more at the end
  std::vector<Sample> samples;
};

struct Film {
  int width = 0;  ///< of the display window
  int height = 0;
  PixelRect data_window;
  std::vector<Plane> planes;
  FilmMetadata metadata;
  DeepAlpha deep;  ///< empty unless requested

  /// The plane of that channel, or nullptr.
  [[nodiscard]] const Plane* find(const std::string& channel) const;
};

/// `text` reduced to letters, digits and underscores, for layer names; never empty, at most
/// 200 characters.
std::string layer_name(const std::string& text);

enum class ExrCompression : std::uint8_t {
  none,
  zips,  ///< lossless, line by line
  zip,   ///< lossless, 16 lines at a time
  piz,   ///< lossless wavelets
  dwaa,  ///< lossy, 32 lines at a time; only for colours, and with `multipart`
};

/// How a film is stored.
struct ExrFormat {
  ExrCompression compression = ExrCompression::zip;  ///< with dwaa, data such as normals have zip
  bool multipart = false;                            ///< a part for each layer
  /// Layers of 16-bit floats ("ao", "light" for all lights), or "all". Z, P, motion, samples and
  /// Cryptomattes always have 32 bits. Finite values beyond 65504 become 65504.
  std::vector<std::string> half = {};
};

/// Throws Error usage, which names the command line's flag, for a layer that cannot be half and for
/// dwaa without parts.
void validate(const ExrFormat& format);

/// Writes a scanline EXR. It writes a temporary file in the same folder, reopens and verifies it,
/// and renames it to `path`. Throws Error usage as validate(), and failed; an existing file at
/// `path` is then unchanged.
void write_exr(const Film& film, const std::string& path, const ExrFormat& format = {});

/// Writes film.deep as a deep scanline EXR with the channels A and Z, in the same way. Throws Error
/// failed.
void write_deep_exr(const Film& film, const std::string& path);

/// Reads any EXR, scanline or tiled, without subsampling or deep data and of at most 2^28 pixels;
/// parts must have one data window. HALF and UINT become float. Planes and settings are in
/// alphabetical order. Throws Error input.
Film read_exr(const std::string& path);

/// How write_png() shows RGBA.
struct PngOptions {
  enum class Background : std::uint8_t {
    sky,    ///< a sky above a grey plain
    none,   ///< the file has an alpha channel
    color,  ///< `color`
  };
  std::optional<float> exposure = {};  ///< in stops: values times 2^exposure; none: automatic
  Background background = Background::sky;
  V3f color{0, 0, 0};  ///< linear, [0,1]; on the display, without exposure
};

/// Throws Error usage, which names the command line's flag, for an exposure that is not a number
/// from -100 to 100, a background that is no enumerator, and a color outside [0,1].
void validate(const PngOptions& options);

/// Writes an 8-bit sRGB picture of the data window's size: of RGBA, exposed, tone mapped, over a
/// background; or of `layer` if it is not empty ("ao", "N", "light.key", ...). Values of layers are
/// clamped to [0,1]. N (from [-1,1]) and Z, P (from their finite range) are mapped linearly; lights
/// are divided by their largest value. Throws Error usage if there is no such layer and as
/// validate(), otherwise failed.
void write_png(const Film& film, const std::string& path, const std::string& layer = "",
               const PngOptions& options = {});

/// Writes an 8-bit heat map of one channel: black at 0, pale yellow at its largest value. Throws
/// Error usage if there is no such channel, otherwise failed.
void write_heat_map(const Film& film, const std::string& path, const std::string& channel);

}  // namespace dapple
