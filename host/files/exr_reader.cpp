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
#include <map>
#include <new>
#include <set>
#include <stdexcept>

#include "dapple/error.hpp"

namespace dapple {
namespace {

using Imath::Box2i;
using Imath::V2i;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::size_t kMaxParts = 65536;  // one a layer: a scene may have thousands of lights
constexpr std::size_t kMaxName = 255;     ///< of an attribute or its type
constexpr std::uint32_t kStripRows = 64;  // at most; a multiple of ZIP's blocks of 16 rows
constexpr std::uint64_t kStripBytes = 1u << 28;
constexpr std::uint64_t kMostTimes = 1100;  // that ZIP makes bytes of an image fewer

std::int64_t area(const Box2i& window) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  return width * (std::int64_t{window.max.y} - window.min.y + 1);
}

/// A text of a header, up to its zero, as OpenEXR limits it.
std::string read_name(Imf::IStream& stream) {
  std::string name;
  for (char c = 0; stream.read(&c, 1), c != 0;) {
    name += c;
    if (name.size() > kMaxName) throw std::runtime_error("a name in its header is too long");
  }
  return name;
}

std::uint32_t read_number(Imf::IStream& stream) {
  std::array<char, 4> bytes{};
  stream.read(bytes.data(), static_cast<int>(bytes.size()));
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    number |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return number;
}

/// Bytes of the types of fixed size, which OpenEXR reads whatever size an attribute claims.
const std::map<std::string, std::uint64_t> kFixedSizes = {
    {"box2f", 16},
    {"box2i", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33d", 72},
    {"m33f", 36},
    {"m44d", 128},
    {"m44f", 64},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2d", 16},
    {"v2f", 8},
    {"v2i", 8},
    {"v3d", 24},
    {"v3f", 12},
    {"v3i", 12},
};

/// Of a value that begins here and claims `claimed` bytes, those that OpenEXR reads. Texts in lists
/// and previews have sizes of their own, for which it allocates memory.
std::uint64_t bytes_read(Imf::IStream& stream, const std::string& type, std::uint64_t claimed) {
  constexpr std::uint64_t kChannel = 16, kPixel = 4;
  if (const auto fixed = kFixedSizes.find(type); fixed != kFixedSizes.end()) return fixed->second;
  if (type == "floatvector") return claimed / 4 * 4;
  const std::uint64_t begin = stream.tellg();
  if (type == "chlist") {
    while (!read_name(stream).empty()) stream.seekg(stream.tellg() + kChannel);
  } else if (type == "stringvector") {
    while (stream.tellg() < begin + claimed) {
      const std::uint32_t length = read_number(stream);
      stream.seekg(stream.tellg() + length);
    }
  } else if (type == "preview") {
    const std::uint64_t width = read_number(stream), height = read_number(stream);
    if (width * height > claimed) return 0;  // also where it is more than 64 bits
    return 8 + kPixel * width * height;
  } else {
    return claimed;
  }
  return stream.tellg() - begin;
}

/// OpenEXR allocates the memory that an attribute claims before it reads it, so this must be in the
/// file, and what it reads must be what is claimed: else the next bytes would count as attributes.
/// Leaves the stream at the beginning of the header, where it is.
void check_attributes(Imf::IStream& stream, std::uint64_t file_bytes) {
  const std::uint64_t begin = stream.tellg();
  for (std::string name = read_name(stream); !name.empty(); name = read_name(stream)) {
    const std::string type = read_name(stream);
    const std::uint64_t claimed = read_number(stream), value = stream.tellg();
    if (claimed > file_bytes || value + claimed > file_bytes)
      throw std::runtime_error("damaged: an attribute of its header is larger than the file");
    if (bytes_read(stream, type, claimed) != claimed)
      throw std::runtime_error("damaged: the attribute " + name + " of its header has " +
                               std::to_string(claimed) + " bytes, which no " + type + " has");
    stream.seekg(value + claimed);
  }
  stream.seekg(begin);
}

// Reads only the headers, one for each part; OpenEXR does not yet allocate memory of the size that
// they claim.
std::vector<Imf::Header> peek_headers(const std::string& path, std::uint64_t file_bytes) {
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
    check_attributes(stream, file_bytes);
    headers.emplace_back();
    headers.back().readFrom(stream, version);
    // As OpenEXR does: where there is one part, the version tells, not what the header says.
    if (!Imf::isMultiPart(version) && !Imf::isNonImage(version))
      headers.back().setType(Imf::isTiled(version) ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    if (headers.size() > kMaxParts) {
      throw std::runtime_error("it has more than " + std::to_string(kMaxParts) + " parts");
    }
  } while (Imf::isMultiPart(version) && !headers.back().readsNothing());
  if (headers.size() > 1) headers.pop_back();  // the empty one that ends the list
  return headers;
}

/// A file without tiles may have the attribute `tiles` all the same.
bool is_tiled(const Imf::Header& header) {
  return header.hasType() && header.type() == Imf::TILEDIMAGE;
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
  if (!is_tiled(header)) return;
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

/// Chunks, of at most 256 rows or a tile each. OpenEXR reads a table of where each begins.
std::uint64_t fewest_chunks(const Imf::Header& header) {
  const Box2i& window = header.dataWindow();
  const auto width = static_cast<std::uint64_t>(window.max.x - window.min.x) + 1;
  const auto height = static_cast<std::uint64_t>(window.max.y - window.min.y) + 1;
  const auto ceiling = [](std::uint64_t whole, std::uint64_t part) {
    return (whole + part - 1) / part;
  };
  if (!is_tiled(header)) return ceiling(height, 256);
  const Imf::TileDescription& tile = header.tileDescription();
  return ceiling(width, std::max(1u, tile.xSize)) * ceiling(height, std::max(1u, tile.ySize));
}

/// Of all channels of a row, as floats.
std::uint64_t row_bytes(const Imf::Header& header) {
  const Box2i& window = header.dataWindow();
  const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
  std::uint64_t channels = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channels;
  return width * sizeof(float) * channels;
}

void check_headers(const std::vector<Imf::Header>& headers, std::uint64_t file_bytes) {
  for (const Imf::Header& header : headers) {
    check_size(header);
    if (fewest_chunks(header) > file_bytes / sizeof(std::uint64_t) ||
        row_bytes(header) / kMostTimes > file_bytes)
      throw std::runtime_error("damaged: its image is larger than the file");
    if (header.hasType() && Imf::isDeepData(header.type())) {
      throw std::runtime_error("it has deep data, which is not read");
    }
    if (header.dataWindow() != headers[0].dataWindow()) {
      throw std::runtime_error("its parts have different data windows");
    }
  }
}

// Channels of several parts may have one name; then all but the first get their part's in front.
std::string free_name(const std::set<std::string>& taken, const std::string& part,
                      const std::string& channel) {
  if (!taken.contains(channel)) return channel;
  std::string name = part + "." + channel;
  if (taken.contains(name)) throw std::runtime_error("channel " + name + " is there twice");
  return name;
}

std::vector<ExrFile::Channel> channels_of(const Imf::MultiPartInputFile& file) {
  std::vector<ExrFile::Channel> channels;
  std::set<std::string> taken;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    const std::string part_name = header.hasName() ? header.name() : "";
    for (const std::string& name : channel_names(header)) {
      channels.push_back({free_name(taken, part_name, name), part, name});
      taken.insert(channels.back().name);
    }
  }
  return channels;
}

/// Calls `act`. Errors become Error input and name the path.
template <class Act>
void with_path(const std::string& path, const Act& act) {
  try {
    act();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::input, path + ": there is not enough memory for its image");
  } catch (const std::exception& problem) {
    throw Error(ErrorKind::input, path + ": " + problem.what());
  }
}

void refuse_other_files(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) return;
  throw Error(ErrorKind::input,
              path + (std::filesystem::exists(path, ignored) ? ": it is not a regular file"
                                                             : ": there is no such file"));
}

}  // namespace

ExrFile::ExrFile(const std::string& path) : path_(path) {
  refuse_other_files(path);
  with_path(path, [&] {
    const std::uint64_t file_bytes = std::filesystem::file_size(path);
    check_headers(peek_headers(path, file_bytes), file_bytes);
    file_ = std::make_unique<Imf::MultiPartInputFile>(path.c_str(), Imf::globalThreadCount());
    const Box2i& window = file_->header(0).dataWindow();
    width_ = static_cast<std::uint32_t>(window.max.x - window.min.x + 1);
    height_ = static_cast<std::uint32_t>(window.max.y - window.min.y + 1);
    channels_ = channels_of(*file_);
  });
}

ExrFile::~ExrFile() = default;

const Imf::Header& ExrFile::header() const { return file_->header(0); }

bool ExrFile::is_cropped() const { return header().dataWindow() != header().displayWindow(); }

void ExrFile::read(std::uint32_t first, std::uint32_t count, std::span<const Channel> channels,
                   std::vector<std::vector<float>>& rows) {
  const Box2i& window = header().dataWindow();
  const V2i begin(window.min.x, window.min.y + static_cast<int>(first));
  const Box2i strip(begin, V2i(window.max.x, begin.y + static_cast<int>(count) - 1));
  rows.resize(channels.size());
  with_path(path_, [&] {
    for (std::size_t i = 0; i < channels.size();) {
      const int number = channels[i].part;
      Imf::FrameBuffer buffer;
      for (; i < channels.size() && channels[i].part == number; ++i) {
        rows[i].resize(static_cast<std::size_t>(area(strip)));
        buffer.insert(channels[i].name_in_part,
                      Imf::Slice::Make(Imf::FLOAT, rows[i].data(), strip));
      }
      Imf::InputPart part(*file_, number);
      part.setFrameBuffer(buffer);
      part.readPixels(strip.min.y, strip.max.y);
    }
  });
}

ExrImage ExrFile::image() {
  ExrImage image{width_, height_, {}};
  with_path(path_, [&] {
    std::vector<std::vector<float>*> planes;
    for (const Channel& channel : channels_) {
      planes.push_back(&image.channels[channel.name]);
      // The system allocates reserved memory only when it is filled: a short file that claims a
      // large picture fails before it uses much.
      planes.back()->reserve(std::size_t{width_} * height_);
    }
    const std::uint64_t of_row = sizeof(float) * width_ * channels_.size();
    const auto strip =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kStripBytes / of_row, 1, kStripRows));
    std::vector<std::vector<float>> rows;  // reused, not allocated anew: experiment 803
    for (std::uint32_t y = 0; y < height_; y += strip) {
      read(y, std::min(strip, height_ - y), channels_, rows);
      for (std::size_t i = 0; i < rows.size(); ++i)
        planes[i]->insert(planes[i]->end(), rows[i].begin(), rows[i].end());
    }
  });
  return image;
}

}  // namespace dapple
