// Reads EXR files: images of dome lights, and films. In: a path. Out: channels of floats, or an
// Error. Only files/exr_* and film/exr/exr_writer.cpp use OpenEXR.
#pragma once

#include <ImfForward.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dapple {

/// Row-major over the data window, top row first.
struct ExrImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::map<std::string, std::vector<float>> channels;
};

/// An open EXR file: any, scanline or tiled, without subsampling or deep data and of at most 2^28
/// pixels. Parts must have one data window. Every member but the destructor throws Error input.
class ExrFile {
 public:
  explicit ExrFile(const std::string& path);
  ~ExrFile();
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  /// That of the first part.
  [[nodiscard]] const Imf::Header& header() const;
  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  /// Whether the data window is not the display window.
  [[nodiscard]] bool is_cropped() const;

  struct Channel {
    std::string name;  ///< with the part's in front if an earlier part has one of that name
    int part = 0;
    std::string name_in_part = {};
  };
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }

  /// Reads `count` rows from row `first` of the data window on to `rows`, a vector for each of
  /// `channels`, which are in the order of parts. HALF and UINT become float.
  void read(std::uint32_t first, std::uint32_t count, std::span<const Channel> channels,
            std::vector<std::vector<float>>& rows);

  /// All channels.
  [[nodiscard]] ExrImage image();

 private:
  std::string path_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::uint32_t width_ = 0, height_ = 0;
  std::vector<Channel> channels_;
};

}  // namespace dapple
