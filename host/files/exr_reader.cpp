// Checks the header before it allocates memory of the size that the header claims.
#include "files/exr_reader.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfStdIO.h>
#include <ImfTileDescriptionAttribute.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "dapple/error.hpp"

namespace dapple {
namespace {

using Imath::Box2i;
using Imath::V2i;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr int kStripRows = 64;  // a multiple of ZIP's blocks of 16 rows

std::int64_t area(const Box2i& window) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  return width * (std::int64_t{window.max.y} - window.min.y + 1);
}

void read_rows(Imf::InputFile& file, const std::vector<std::string>& channels, const Box2i& strip,
               ExrRows& rows) {
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    rows[i].resize(static_cast<std::size_t>(area(strip)));
    buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, rows[i].data(), strip));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(strip.min.y, strip.max.y);
}

// Reads only the header; OpenEXR does not yet allocate memory of the size that it claims.
Imf::Header peek_header(const std::string& path) {
  Imf::StdIFStream stream(path.c_str());
  std::array<char, 8> opening{};
  stream.read(opening.data(), static_cast<int>(opening.size()));
  if (!Imf::isImfMagic(opening.data())) throw std::runtime_error("it is not an EXR file");
  int version = 0;
  for (std::size_t i = 4; i < 8; ++i) {
    version |= static_cast<unsigned char>(opening[i]) << (8 * (i - 4));
  }
  Imf::Header header;
  header.readFrom(stream, version);
  return header;
}

void check_size(const Imf::Header& header) {
  const Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1) throw std::runtime_error("its data window is empty");
  const auto too_large = [](std::int64_t w, std::int64_t h) {
    return w > kMaxPixels || h > kMaxPixels || w * h > kMaxPixels;
  };
  if (too_large(width, height)) {
    throw std::runtime_error("its data window of " + std::to_string(width) + " x " +
                             std::to_string(height) + " pixels is over the limit of " +
                             std::to_string(kMaxPixels));
  }
  if (!header.hasTileDescription()) return;
  // OpenEXR keeps one row of tiles for scanline access.
  const Imf::TileDescription& tile = header.tileDescription();
  if (too_large(tile.xSize, tile.ySize) || too_large(width, tile.ySize)) {
    throw std::runtime_error("its tiles of " + std::to_string(tile.xSize) + " x " +
                             std::to_string(tile.ySize) + " pixels are too large");
  }
}

std::vector<std::string> channel_names(const Imf::Header& header) {
  std::vector<std::string> names;
  const Imf::ChannelList& channels = header.channels();
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      throw std::runtime_error(std::string("channel ") + it.name() + " is subsampled");
    }
    names.emplace_back(it.name());
  }
  if (names.empty()) throw std::runtime_error("it has no channels");
  return names;
}

ExrImage decode(const std::string& path, const SeeExrHeader& see_header) {
  check_size(peek_header(path));
  Imf::InputFile file(path.c_str(), 0);
  const Box2i& window = file.header().dataWindow();
  if (see_header) see_header(file.header());
  const std::vector<std::string> channels = channel_names(file.header());
  ExrImage image;
  image.width = static_cast<std::uint32_t>(window.max.x - window.min.x + 1);
  image.height = static_cast<std::uint32_t>(window.max.y - window.min.y + 1);
  // The system allocates reserved memory only when it is filled: a short file that claims a large
  // picture fails before it uses much.
  for (const std::string& channel : channels)
    image.channels[channel].reserve(static_cast<std::size_t>(area(window)));
  for_each_strip(file, channels, [&](std::size_t, const ExrRows& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::vector<float>& pixels = image.channels[channels[i]];
      pixels.insert(pixels.end(), rows[i].begin(), rows[i].end());
    }
  });
  return image;
}

}  // namespace

void for_each_strip(
    Imf::InputFile& file, const std::vector<std::string>& channels,
    const std::function<void(std::size_t first_pixel, const ExrRows& rows)>& visit) {
  const Box2i window = file.header().dataWindow();
  std::size_t first_pixel = 0;
  ExrRows rows(channels.size());  // reused, not allocated anew: experiment 803
  for (std::int64_t y = window.min.y; y <= window.max.y; y += kStripRows) {
    const int last = static_cast<int>(std::min<std::int64_t>(y + kStripRows - 1, window.max.y));
    const Box2i strip(V2i(window.min.x, static_cast<int>(y)), V2i(window.max.x, last));
    read_rows(file, channels, strip, rows);
    visit(first_pixel, rows);
    first_pixel += static_cast<std::size_t>(area(strip));
  }
}

ExrImage read_exr_image(const std::string& path, const SeeExrHeader& see_header) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorKind::input,
                path + (std::filesystem::exists(path, ignored) ? ": it is not a regular file"
                                                               : ": there is no such file"));
  }
  try {
    return decode(path, see_header);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::input, path + ": there is not enough memory for its image");
  } catch (const std::exception& problem) {
    throw Error(ErrorKind::input, path + ": " + problem.what());
  }
}

}  // namespace dapple
