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
#include <openexr.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <new>
#include <set>
#include <stdexcept>

#include "dapple/error.hpp"

namespace dapple {
namespace {

using Imath::Box2i;
using Imath::V2i;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::size_t kMaxParts = 4096;
constexpr std::uint32_t kStripRows = 64;  // a multiple of ZIP's blocks of 16 rows

std::int64_t area(const Box2i& window) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  return width * (std::int64_t{window.max.y} - window.min.y + 1);
}

void keep_message(exr_const_context_t file, exr_result_t, const char* message) {
  void* kept = nullptr;
  exr_get_user_data(file, &kept);
  if (kept != nullptr) *static_cast<std::string*>(kept) = message;
}

/// OpenEXR's C++ interface allocates the memory that a header claims before it reads it. Its C
/// interface, which is asked first, compares each size with the file and with the attribute's type.
/// It goes on after some of what it complains of.
void check_attributes(const std::string& path) {
  std::string message;
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.user_data = &message;
  settings.error_handler_fn = keep_message;
  exr_context_t file = nullptr;
  const exr_result_t result = exr_start_read(&file, path.c_str(), &settings);
  if (result == EXR_ERR_SUCCESS) exr_finish(&file);
  if (result == EXR_ERR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (result != EXR_ERR_SUCCESS || !message.empty())
    throw std::runtime_error("damaged: its header: " + message);
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
  check_attributes(path);
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
    check_headers(peek_headers(path));
    file_ = std::make_unique<Imf::MultiPartInputFile>(path.c_str(), Imf::globalThreadCount());
    const Box2i& window = file_->header(0).dataWindow();
    width_ = static_cast<std::uint32_t>(window.max.x - window.min.x + 1);
    height_ = static_cast<std::uint32_t>(window.max.y - window.min.y + 1);
    channels_ = channels_of(*file_);
  });
}

ExrFile::~ExrFile() = default;

const Imf::Header& ExrFile::header() const { return file_->header(0); }

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
    std::vector<std::vector<float>> rows;  // reused, not allocated anew: experiment 803
    for (std::uint32_t y = 0; y < height_; y += kStripRows) {
      read(y, std::min(kStripRows, height_ - y), channels_, rows);
      for (std::size_t i = 0; i < rows.size(); ++i)
        planes[i]->insert(planes[i]->end(), rows[i].begin(), rows[i].end());
    }
  });
  return image;
}

}  // namespace dapple
