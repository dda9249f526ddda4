// Checks the header before it allocates memory of the size that the header claims.
#include "files/exr_reader.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfThreading.h>
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

using ExrRows = std::vector<std::vector<float>>;  ///< one vector for each channel

using Imath::Box2i;
using Imath::V2i;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::size_t kMaxParts = 4096;
constexpr int kStripRows = 64;  // a multiple of ZIP's blocks of 16 rows

std::int64_t area(const Box2i& window) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  return width * (std::int64_t{window.max.y} - window.min.y + 1);
}

void read_rows(Imf::InputPart& part, const std::vector<std::string>& channels, const Box2i& strip,
               ExrRows& rows) {
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    rows[i].resize(static_cast<std::size_t>(area(strip)));
    buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, rows[i].data(), strip));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(strip.min.y, strip.max.y);
}

// Reads only the headers, one for each part; OpenEXR does not yet allocate memory of the size that
// they claim.
std::vector<Imf::Header> peek_headers(const std::string& path) {
  Imf::StdIFStream stream(path.c_str());
  std::array<char, 8> opening{};
  stream.read(opening.data(), static_cast<int>(opening.size()));
  if (!Imf::isImfMagic(opening.data())) throw std::runtime_error("it is not an EXR file");
  int version = 0;
  for (std::size_t i = 4; i < 8; ++i) {
    version |= static_cast<unsigned char>(opening[i]) << (8 * (i - 4));
  }
  std::vector<Imf::Header> headers;
  do {
    headers.emplace_back();
    headers.back().readFrom(stream, version);
    if (headers.size() > kMaxParts) {
      throw std::runtime_error("it has more than " + std::to_string(kMaxParts) + " parts");
    }
  } while (Imf::isMultiPart(version) && !headers.back().readsNothing());
  if (headers.size() > 1) headers.pop_back();  // the empty one that ends the list
  return headers;
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

void check_headers(const std::vector<Imf::Header>& headers) {
  for (const Imf::Header& header : headers) {
    check_size(header);
    if (header.hasType() && Imf::isDeepData(header.type())) {
      throw std::runtime_error("it has deep data, which is not read");
    }
    if (header.dataWindow() != headers[0].dataWindow()) {
      throw std::runtime_error("its parts have different data windows");
    }
  }
}

// Channels of several parts may have one name; then all but the first get their part's in front.
std::string free_name(const ExrImage& image, const std::string& part, const std::string& channel) {
  if (!image.channels.contains(channel)) return channel;
  std::string name = part + "." + channel;
  if (image.channels.contains(name))
    throw std::runtime_error("channel " + name + " is there twice");
  return name;
}

void decode_part(Imf::InputPart& part, ExrImage& image) {
  const std::vector<std::string> channels = channel_names(part.header());
  std::vector<std::vector<float>*> planes;
  for (const std::string& channel : channels) {
    const std::string name = part.header().hasName() ? part.header().name() : "";
    planes.push_back(&image.channels[free_name(image, name, channel)]);
    // The system allocates reserved memory only when it is filled: a short file that claims a large
    // picture fails before it uses much.
    planes.back()->reserve(static_cast<std::size_t>(area(part.header().dataWindow())));
  }
  const Box2i window = part.header().dataWindow();
  ExrRows rows(channels.size());  // reused, not allocated anew: experiment 803
  for (std::int64_t y = window.min.y; y <= window.max.y; y += kStripRows) {
    const int last = static_cast<int>(std::min<std::int64_t>(y + kStripRows - 1, window.max.y));
    read_rows(part, channels,
              Box2i(V2i(window.min.x, static_cast<int>(y)), V2i(window.max.x, last)), rows);
    for (std::size_t i = 0; i < rows.size(); ++i)
      planes[i]->insert(planes[i]->end(), rows[i].begin(), rows[i].end());
  }
}

ExrImage decode(const std::string& path, const SeeExrHeader& see_header) {
  check_headers(peek_headers(path));
  Imf::MultiPartInputFile file(path.c_str(), Imf::globalThreadCount());
  const Box2i& window = file.header(0).dataWindow();
  if (see_header) see_header(file.header(0));
  ExrImage image;
  image.width = static_cast<std::uint32_t>(window.max.x - window.min.x + 1);
  image.height = static_cast<std::uint32_t>(window.max.y - window.min.y + 1);
  for (int i = 0; i < file.parts(); ++i) {
    Imf::InputPart part(file, i);
    decode_part(part, image);
  }
  return image;
}

}  // namespace

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
